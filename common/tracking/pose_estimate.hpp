#pragma once

#include <cstdint>
#include <string>

#include "common/egraph/types.hpp"

namespace eg::tracking {

enum class TrackingState : std::uint8_t {
  initialising = 0,   ///< no map yet; there is no pose
  tracking = 1,       ///< full 6-DoF pose
  rotation_only = 2,  ///< rotation from the E-Graph, translation predicted
  lost = 3,           ///< no pose that can be trusted
  relocalised = 4,    ///< 6-DoF pose found again after lost; the next good frame is `tracking`
};

const char* to_string(TrackingState state);

/// The tracker's answer to one frame.
struct PoseEstimate {
  image::FrameHeader header;
  TrackingState state = TrackingState::initialising;
  std::string reason;                ///< why it is in this state, for a person; at most 200 characters
  bool has_pose = false;             ///< whether `world_from_camera` means anything
  geometry::Pose world_from_camera;  ///< world: the first keyframe's camera
  egraph::Matrix6d covariance = egraph::Matrix6d::Zero();  ///< of (rotation, translation), left perturbation; rad, m
  egraph::KeyframeId keyframe;                             ///< the keyframe that this frame became; invalid: none
  egraph::KeyframeId rotation_reference;  ///< oldest keyframe that shares two or more directions; invalid: none
  std::int32_t matched_points = 0;
  std::int32_t matched_lines = 0;
  std::int32_t matched_planes = 0;
  std::int32_t matched_directions = 0;
  std::int64_t corrections = 0;  ///< version of the newest PoseCorrection so far; 0: none
};

/// New poses for keyframes that were already announced (local or global optimisation moved them). Who has everything up
/// to `since`, then has everything up to `version`.
struct PoseCorrection {
  std::int64_t session = 0;
  std::int64_t version = 0;
  using Entry = egraph::CorrectedPose;
  std::vector<Entry> entries;
  std::int64_t since = 0;  ///< less than `version`; 0: it holds every keyframe that was ever moved
};

}  // namespace eg::tracking
