#include "common/egraph/snapshot_parts.hpp"

#include <algorithm>
#include <utility>

namespace eg::egraph {
namespace {

// Encoded sizes (docs/messages.md), rounded up.
constexpr std::size_t kKeyframeBytes = 300;
constexpr std::size_t kLandmarkBytes = 90;
constexpr std::size_t kObservationBytes = 80;
constexpr std::size_t kCovisibilityBytes = 12;
constexpr std::size_t kRelativePoseBytes = 280;

/// What the parts of one snapshot may come to: the bus is open to everybody, and memory is not endless.
constexpr std::size_t kMaxSnapshotBytes = std::size_t{1} << 29U;

std::size_t encoded_bytes(const GraphSnapshot& part) {
  return part.keyframes.size() * kKeyframeBytes + part.landmarks.size() * kLandmarkBytes +
         part.observations.size() * kObservationBytes + part.covisibility.size() * kCovisibilityBytes +
         part.relative_poses.size() * kRelativePoseBytes;
}

GraphSnapshot empty_part(const GraphSnapshot& whole) {
  GraphSnapshot part;
  part.session = whole.session;
  part.version = whole.version;
  part.next_landmark = whole.next_landmark;
  return part;
}

class Splitter {
 public:
  Splitter(const GraphSnapshot& whole, std::size_t max_bytes)
      : whole_(whole), max_bytes_(max_bytes), parts_{empty_part(whole)} {}

  template <typename Item>
  void add(std::vector<Item> GraphSnapshot::*list, std::size_t item_bytes) {
    for (const Item& item : whole_.*list) {
      if (bytes_ > 0 && bytes_ + item_bytes > max_bytes_) {
        parts_.push_back(empty_part(whole_));
        bytes_ = 0;
      }
      (parts_.back().*list).push_back(item);
      bytes_ += item_bytes;
    }
  }

  std::vector<GraphSnapshot> take() {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      parts_[i].part = static_cast<std::int32_t>(i);
      parts_[i].parts = static_cast<std::int32_t>(parts_.size());
    }
    return std::move(parts_);
  }

 private:
  const GraphSnapshot& whole_;
  std::size_t max_bytes_;
  std::size_t bytes_ = 0;  ///< of the last part
  std::vector<GraphSnapshot> parts_;
};

template <typename Item>
void append(std::vector<Item>& to, std::vector<Item>& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

std::vector<GraphSnapshot> split(const GraphSnapshot& snapshot, std::size_t max_bytes) {
  Splitter splitter(snapshot, max_bytes);
  splitter.add(&GraphSnapshot::keyframes, kKeyframeBytes);
  splitter.add(&GraphSnapshot::landmarks, kLandmarkBytes);
  splitter.add(&GraphSnapshot::observations, kObservationBytes);
  splitter.add(&GraphSnapshot::covisibility, kCovisibilityBytes);
  splitter.add(&GraphSnapshot::relative_poses, kRelativePoseBytes);
  return splitter.take();
}

std::optional<GraphSnapshot> SnapshotAssembler::add(const GraphSnapshot& part) {
  if (!parts_.empty()) {
    const GraphSnapshot& other = parts_.begin()->second;
    const bool same = other.session == part.session && other.version == part.version && other.parts == part.parts;
    if (!same && other.session == part.session && other.version > part.version) return std::nullopt;
    if (!same) clear();
  }
  if (parts_.try_emplace(part.part, part).second) bytes_ += encoded_bytes(part);
  if (bytes_ > kMaxSnapshotBytes) clear();
  if (parts_.size() < static_cast<std::size_t>(part.parts)) return std::nullopt;
  GraphSnapshot whole = empty_part(part);
  for (auto& [number, piece] : parts_) {
    append(whole.keyframes, piece.keyframes);
    append(whole.landmarks, piece.landmarks);
    append(whole.observations, piece.observations);
    append(whole.covisibility, piece.covisibility);
    append(whole.relative_poses, piece.relative_poses);
  }
  clear();
  return whole;
}

void SnapshotAssembler::clear() {
  parts_.clear();
  bytes_ = 0;
}

}  // namespace eg::egraph
