#include "services/viewer/board.hpp"

#include <utility>

namespace eg::services {

bool Board::put(const std::string& key, std::vector<std::uint8_t> bytes) {
  const std::scoped_lock lock(mutex_);
  const auto known = stamps_.find(key);
  std::size_t replaced = 0;
  if (known != stamps_.end()) {
    const Bytes& old = packets_.at(known->second);
    if (*old == bytes) return true;
    replaced = old->size();
  }
  if (total_bytes_ - replaced + bytes.size() > max_bytes_) return false;
  if (known != stamps_.end()) {
    packets_.erase(known->second);
    total_bytes_ -= replaced;
  }
  insert(key, std::move(bytes));
  return true;
}

void Board::restart(const std::string& key, std::vector<std::uint8_t> first) {
  const std::scoped_lock lock(mutex_);
  packets_.clear();
  stamps_.clear();
  total_bytes_ = 0;
  insert(key, std::move(first));
}

std::optional<Board::Item> Board::next(std::uint64_t stamp) const {
  const std::scoped_lock lock(mutex_);
  const auto found = packets_.upper_bound(stamp);
  if (found == packets_.end()) return std::nullopt;
  return Item{found->first, found->second};
}

std::size_t Board::bytes() const {
  const std::scoped_lock lock(mutex_);
  return total_bytes_;
}

std::uint64_t Board::latest() const {
  const std::scoped_lock lock(mutex_);
  return latest_;
}

void Board::insert(const std::string& key, std::vector<std::uint8_t> bytes) {
  total_bytes_ += bytes.size();
  ++latest_;
  stamps_[key] = latest_;
  packets_.emplace(latest_, std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes)));
}

}  // namespace eg::services
