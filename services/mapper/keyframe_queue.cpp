#include "services/mapper/keyframe_queue.hpp"

#include <algorithm>

namespace eg::services {
namespace {

constexpr std::int64_t kPeriod = 300'000;  // microseconds between two requests: longer than a frame takes by itself
constexpr int kMaxRequests = 25;           // 7.5 s: the frame source keeps frames for 10 s
constexpr std::size_t kMaxAtOnce = 16;     // frames asked for: half a second of a camera's bandwidth
constexpr std::size_t kMaxOpen = 10'000;   // keyframes; who announces more makes a mistake

}  // namespace

void KeyframeQueue::announce(egraph::KeyframeId id) {
  if (std::int64_t{id.value} - announced_ > static_cast<std::int64_t>(kMaxOpen - open_.size())) return;
  while (announced_ < id.value) open_.try_emplace(++announced_);
}

bool KeyframeQueue::add_pose(const tracking::PoseEstimate& pose) {
  announce(pose.keyframe);
  const auto entry = open_.find(pose.keyframe.value);
  if (entry == open_.end()) return false;
  if (!entry->second.pose) entry->second = {pose, 0};
  return true;
}

const tracking::PoseEstimate* KeyframeQueue::waiting_for(std::int64_t sequence) const {
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const auto& item) {
    return item.second.pose && item.second.pose->header.sequence == sequence;
  });
  return found == open_.end() ? nullptr : &*found->second.pose;
}

void KeyframeQueue::finish(egraph::KeyframeId id) { open_.erase(id.value); }

KeyframeQueue::Missing KeyframeQueue::to_request(std::int64_t now_utime) {
  Missing missing;
  if (open_.empty()) last_request_ = now_utime;  // what is announced next has a whole period to come by itself
  if (now_utime - last_request_ < kPeriod) return missing;
  last_request_ = now_utime;
  given_up_ += static_cast<std::int64_t>(
      std::erase_if(open_, [](const auto& item) { return item.second.requests >= kMaxRequests; }));
  // The newest first: a mapper that comes late gets what can still be had.
  for (auto item = open_.rbegin(); item != open_.rend(); ++item) {
    Entry& entry = item->second;
    if ((entry.pose ? missing.parts.size() : missing.poses.size()) >= kMaxAtOnce) continue;
    ++entry.requests;
    if (entry.pose) {
      missing.parts.push_back(*entry.pose);
    } else {
      missing.poses.push_back(item->first);
    }
  }
  return missing;
}

}  // namespace eg::services
