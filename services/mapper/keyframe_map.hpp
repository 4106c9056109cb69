#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "common/features/features.hpp"
#include "common/image/rectifier.hpp"
#include "common/mapping/tsdf_map.hpp"
#include "common/messages/codec.hpp"
#include "common/tracking/pose_estimate.hpp"

namespace eg::services {

/// A keyframe that the tracker has tracked in all six degrees of freedom: only those are mapped.
inline bool is_mapped(const tracking::PoseEstimate& pose) {
  return pose.keyframe.valid() && pose.has_pose && pose.state == tracking::TrackingState::tracking;
}

/// The part of a frame's features that the map needs.
inline features::FrameFeatures planes_only(const features::FrameFeatures& features) {
  return {features.header, features.camera, {}, {}, features.planes, {}};
}

/// The dense map as a function of the keyframes and their latest poses. It keeps each keyframe's compressed images and
/// the planes that its depth was regularised by, so that a keyframe whose pose is corrected can be taken out of the
/// field and put back where it belongs.
class KeyframeMap {
 public:
  struct Keyframe {
    geometry::Pose world_from_camera;                 ///< where it is in the field
    std::optional<messages::CompressedFrame> images;  ///< none: dropped for the budget
    features::FrameFeatures planes;                   ///< of the rectified image, and nothing else; none: fused as read
  };

  /// @param image_budget bytes of compressed images and planes kept; beyond it the oldest keyframes stay where they are
  KeyframeMap(const mapping::TsdfOptions& options, std::size_t image_budget);

  /// Fuses a keyframe, its readings on the planes of `features` after mapping::regularise_depth(). One that is there
  /// already changes nothing, nor does a failure.
  base::Status integrate(egraph::KeyframeId id, const messages::CompressedFrame& frame,
                         const geometry::Pose& world_from_camera, const features::FrameFeatures& features = {});

  /// Takes note of a keyframe that the field holds already, at that pose.
  void restore(egraph::KeyframeId id, Keyframe keyframe);

  [[nodiscard]] const std::map<egraph::KeyframeId, Keyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] bool contains(egraph::KeyframeId id) const { return keyframes_.contains(id); }

  /// Takes note of new poses, also of keyframes that are yet to come. Older versions than the known ones are ignored.
  void correct(const tracking::PoseCorrection& correction);

  /// Moves one of the keyframes that are more than a voxel or half a degree from their latest pose. False: there is
  /// none. One that cannot be moved, because a part of the map cannot be brought back from disk, stays or, if it was
  /// taken out already, is no longer in the map; the error says which of the two and why.
  base::Result<bool> move_next();

  /// Moves every keyframe to exactly its latest pose: the field then no longer depends on when corrections came.
  base::Status settle();

  [[nodiscard]] mapping::TsdfMap& field() { return field_; }
  [[nodiscard]] const mapping::TsdfMap& field() const { return field_; }
  [[nodiscard]] std::size_t keyframe_count() const { return keyframes_.size(); }

 private:
  struct LatestPose {
    std::int64_t version = 0;
    geometry::Pose world_from_camera;
  };

  /// What goes into the field.
  [[nodiscard]] base::Result<image::RectifiedFrame> unpack(const messages::CompressedFrame& images,
                                                           const features::FrameFeatures& planes);
  void drop_oldest_images();
  void note_if_far(egraph::KeyframeId id);
  base::Status move(egraph::KeyframeId id);

  mapping::TsdfMap field_;
  std::size_t image_budget_;
  std::size_t image_bytes_ = 0;
  image::Rectifier rectifier_;
  std::map<egraph::KeyframeId, Keyframe> keyframes_;
  std::map<egraph::KeyframeId, LatestPose> latest_poses_;  ///< of corrected keyframes
  std::set<egraph::KeyframeId> far_;                       ///< keyframes to be moved
};

}  // namespace eg::services
