#include "services/frame_source/frame_store.hpp"

#include <utility>

namespace eg::services {

void FrameStore::add(SourceFrame frame) {
  const std::int64_t sequence = header_of(frame).sequence;
  frames_.insert_or_assign(sequence, std::move(frame));
  if (frames_.size() > capacity_) frames_.erase(frames_.begin());
}

void FrameStore::request(const messages::ResendRequest& request) {
  for (const std::int64_t sequence : request.numbers) {
    if (frames_.contains(sequence)) requested_.insert(sequence);
  }
}

const SourceFrame* FrameStore::next() {
  while (!requested_.empty()) {
    const auto frame = frames_.find(requested_.extract(requested_.begin()).value());
    if (frame != frames_.end()) return &frame->second;
  }
  return nullptr;
}

}  // namespace eg::services
