#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace eg::services {

/// What is to be seen right now: the newest packet of every key, in the order in which they last changed.
///
/// A browser needs nothing but a stamp: it is sent the packet with the next larger stamp, again and again. One that
/// comes late begins at 0 and so gets everything once; one that is slow finds only the newest packet of each key when
/// it asks again. No queue is kept per browser, and nobody waits for anybody. Used by several threads.
class Board {
 public:
  using Bytes = std::shared_ptr<const std::vector<std::uint8_t>>;

  struct Item {
    std::uint64_t stamp = 0;
    Bytes bytes;
  };

  /// @param max_bytes of all packets together
  explicit Board(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Replaces the key's packet. The same bytes again change nothing. False: there is no room for it.
  bool put(const std::string& key, std::vector<std::uint8_t> bytes);

  /// Takes everything down and puts `first` up, which every browser will get before anything else.
  void restart(const std::string& key, std::vector<std::uint8_t> first);

  /// The packet that changed first after `stamp`, or nothing.
  [[nodiscard]] std::optional<Item> next(std::uint64_t stamp) const;

  [[nodiscard]] std::size_t bytes() const;
  /// The stamp of the latest change.
  [[nodiscard]] std::uint64_t latest() const;

 private:
  void insert(const std::string& key, std::vector<std::uint8_t> bytes);

  mutable std::mutex mutex_;
  std::size_t max_bytes_;
  std::size_t total_bytes_ = 0;
  std::uint64_t latest_ = 0;
  std::map<std::uint64_t, Bytes> packets_;  ///< by stamp
  std::unordered_map<std::string, std::uint64_t> stamps_;
};

}  // namespace eg::services
