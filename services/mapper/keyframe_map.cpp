#include "services/mapper/keyframe_map.hpp"

#include <numbers>
#include <string>
#include <utility>

#include "common/base/check.hpp"
#include "common/geometry/so3.hpp"
#include "common/mapping/plane_regularisation.hpp"

namespace eg::services {
namespace {

constexpr double kMaxRotation = 0.5 * std::numbers::pi / 180.0;

/// What a keyframe takes that can still be moved.
std::size_t bytes_of(const KeyframeMap::Keyframe& keyframe) {
  std::size_t bytes = keyframe.images->colour.size() + keyframe.images->depth.size();
  for (const features::PlaneFeature& plane : keyframe.planes.planes) {
    bytes += sizeof plane + plane.hull.size() * sizeof plane.hull.front();
  }
  return bytes;
}

std::vector<mapping::DepthPlane> to_depth_planes(const std::vector<features::PlaneFeature>& features) {
  std::vector<mapping::DepthPlane> planes;
  planes.reserve(features.size());
  for (const features::PlaneFeature& feature : features) {
    planes.push_back({feature.plane, feature.covariance, static_cast<double>(feature.support), feature.hull});
  }
  return planes;
}

bool is_same(const geometry::Pose& a, const geometry::Pose& b) {
  return a.rotation == b.rotation && a.translation == b.translation;
}

bool is_far(const geometry::Pose& a, const geometry::Pose& b, double max_distance) {
  return (a.translation - b.translation).norm() > max_distance ||
         geometry::rotation_angle_between(a.rotation, b.rotation) > kMaxRotation;
}

}  // namespace

KeyframeMap::KeyframeMap(const mapping::TsdfOptions& options, std::size_t image_budget)
    : field_(options), image_budget_(image_budget) {}

base::Result<image::RectifiedFrame> KeyframeMap::unpack(const messages::CompressedFrame& images,
                                                        const features::FrameFeatures& planes) {
  return messages::decompress(images).map([&](const image::RgbdFrame& frame) {
    image::RectifiedFrame rectified = rectifier_.rectify(frame);
    if (!planes.planes.empty()) {
      rectified.depth = mapping::regularise_depth(rectified.depth, rectified.camera, to_depth_planes(planes.planes));
    }
    return rectified;
  });
}

base::Status KeyframeMap::integrate(egraph::KeyframeId id, const messages::CompressedFrame& frame,
                                    const geometry::Pose& world_from_camera, const features::FrameFeatures& features) {
  if (keyframes_.contains(id)) return {};
  const auto restored = unpack(frame, features);
  if (!restored) return tl::make_unexpected(restored.error());
  const auto integrated = field_.integrate(*restored, world_from_camera);
  if (!integrated) return tl::make_unexpected(integrated.error());
  Keyframe& keyframe = keyframes_[id] = {world_from_camera, frame, planes_only(features)};
  image_bytes_ += bytes_of(keyframe);
  drop_oldest_images();
  note_if_far(id);
  return {};
}

void KeyframeMap::restore(egraph::KeyframeId id, Keyframe keyframe) {
  if (keyframe.images) image_bytes_ += bytes_of(keyframe);
  keyframes_[id] = std::move(keyframe);
  drop_oldest_images();
}

void KeyframeMap::drop_oldest_images() {
  for (auto it = keyframes_.begin(); it != keyframes_.end() && image_bytes_ > image_budget_; ++it) {
    if (!it->second.images) continue;
    image_bytes_ -= bytes_of(it->second);
    it->second.images.reset();
    it->second.planes = {};
    far_.erase(it->first);
  }
}

void KeyframeMap::correct(const tracking::PoseCorrection& correction) {
  for (const auto& [id, world_from_camera] : correction.entries) {
    const auto [latest, is_first] = latest_poses_.try_emplace(id, LatestPose{correction.version, world_from_camera});
    if (!is_first) {
      if (correction.version <= latest->second.version) continue;
      latest->second = {correction.version, world_from_camera};
    }
    note_if_far(id);
  }
}

void KeyframeMap::note_if_far(egraph::KeyframeId id) {
  const auto keyframe = keyframes_.find(id);
  const auto latest = latest_poses_.find(id);
  if (keyframe == keyframes_.end() || latest == latest_poses_.end() || !keyframe->second.images) return;
  if (is_far(keyframe->second.world_from_camera, latest->second.world_from_camera, field_.options().voxel_size)) {
    far_.insert(id);
  } else {
    far_.erase(id);
  }
}

base::Result<bool> KeyframeMap::move_next() {
  if (far_.empty()) return false;
  const egraph::KeyframeId id = far_.extract(far_.begin()).value();
  return move(id).map([] { return true; });
}

base::Status KeyframeMap::settle() {
  std::vector<egraph::KeyframeId> moved;
  for (const auto& [id, latest] : latest_poses_) {
    const auto keyframe = keyframes_.find(id);
    if (keyframe == keyframes_.end() || !keyframe->second.images) continue;
    if (!is_same(keyframe->second.world_from_camera, latest.world_from_camera)) moved.push_back(id);
  }
  for (const egraph::KeyframeId id : moved) {
    if (auto status = move(id); !status) return status;
    if (auto status = field_.keep_budget(); !status) return status;
  }
  return {};
}

base::Status KeyframeMap::move(egraph::KeyframeId id) {
  Keyframe& keyframe = keyframes_.at(id);
  const geometry::Pose& target = latest_poses_.at(id).world_from_camera;
  const auto frame = unpack(*keyframe.images, keyframe.planes);
  EG_CHECK(frame, "images that were restored once can be restored again");
  const std::string name = "keyframe " + std::to_string(id.value);
  far_.erase(id);
  if (const auto taken = field_.deintegrate(*frame, keyframe.world_from_camera); !taken) {
    return base::fail(name + " stays where it is: " + taken.error().message);
  }
  if (const auto put = field_.integrate(*frame, target); !put) {
    image_bytes_ -= bytes_of(keyframe);
    keyframes_.erase(id);
    return base::fail(name + " is no longer in the map: " + put.error().message);
  }
  keyframe.world_from_camera = target;
  return {};
}

}  // namespace eg::services
