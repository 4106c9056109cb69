#include "common/messages/channels.hpp"
#include "services/mapper/mapper_service.hpp"

/// How the mapper gets what it needs of every keyframe in real time, when anything may be lost.
namespace eg::services {
namespace {

constexpr std::size_t kMaxRecentFrames = 32;  // one second: what a pose may take

}  // namespace

void MapperService::take_pose(const tracking::PoseEstimate& pose) {
  if (!pose.keyframe.valid() || !session_->queue.add_pose(pose)) return;
  if (!is_mapped(pose) || session_->map.contains(pose.keyframe)) return session_->queue.finish(pose.keyframe);
  finish_if_complete(pose.header.sequence);
}

void MapperService::finish_if_complete(std::int64_t sequence) {
  const auto parts = session_->frames.find(sequence);
  const tracking::PoseEstimate* const pose = session_->queue.waiting_for(sequence);
  if (parts == session_->frames.end() || pose == nullptr || !is_complete(parts->second, *pose)) {
    return forget_old_frames();
  }
  integrate(parts->second, *pose);
  session_->queue.finish(pose->keyframe);
  session_->frames.erase(parts);
}

void MapperService::forget_old_frames() {
  // By arrival, not by number: a number that nobody else would give must not stay in the place of honest ones.
  auto& frames = session_->frames;
  while (frames.size() > kMaxRecentFrames) {
    auto oldest = frames.end();
    for (auto it = frames.begin(); it != frames.end(); ++it) {
      const bool older = oldest == frames.end() || it->second.arrival < oldest->second.arrival;
      if (older && session_->queue.waiting_for(it->first) == nullptr) oldest = it;
    }
    if (oldest == frames.end()) return;
    frames.erase(oldest);
  }
}

void MapperService::request_missing(std::int64_t now_utime) {
  const std::int64_t given_up = session_->queue.given_up();
  const KeyframeQueue::Missing missing = session_->queue.to_request(now_utime);
  std::vector<std::int64_t> images;    // of frames
  std::vector<std::int64_t> features;  // of keyframes
  for (const tracking::PoseEstimate& pose : missing.parts) {
    const auto found = session_->frames.find(pose.header.sequence);
    const bool has_any = found != session_->frames.end();
    if (!has_any || !found->second.images) images.push_back(pose.header.sequence);
    if (options_.plane_regularisation && (!has_any || !found->second.features)) features.push_back(pose.keyframe.value);
  }
  request(messages::channels::kPose, missing.poses);
  request(messages::channels::kRgbd, images);
  request(messages::channels::kKeyframeFeatures, features);
  if (const auto have = session_->corrections.to_request(now_utime))
    request(messages::channels::kPoseCorrection, {*have});
  context_.status().count_dropped(session_->queue.given_up() - given_up);
}

}  // namespace eg::services
