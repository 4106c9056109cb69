#include <optional>
#include <string>

#include "common/tracking/tracker_frame.hpp"

/// What the tracker does when it does not know where it is.
namespace eg::tracking {
namespace {

using features::FrameFeatures;
using geometry::Pose;

/// Radians and metres: what is known of a pose of which nothing is known.
constexpr double kUnknown = 1.0;

}  // namespace

std::optional<Tracker::Frame> Tracker::find_known_place(const FrameFeatures& features) {
  // The newest keyframe first: most losses are a quick turn. Then the others in turn, a few per frame.
  const auto keyframes = map_.keyframes();
  for (int candidate = 0; candidate < options_.relocalisation_candidates; ++candidate) {
    const std::size_t index = candidate == 0
                                  ? keyframes.size() - 1
                                  : (next_candidate_ + static_cast<std::size_t>(candidate)) % keyframes.size();
    const auto pose = relocalise(features, map_, keyframes[index], options_.relocaliser);
    if (!pose) continue;
    Frame frame{.features = features, .prediction = known_within(*pose, 0.1, 0.1)};
    frame.camera_from_world = *pose;
    follow_graph_rotation(frame);
    frame.camera_from_world = *pose;
    refine_against_map(frame);
    frame.known_place = keyframes[index].id;
    const Observability observed = observability(frame.solution.information);
    if (frame.solution.inlier_points() >= options_.relocaliser.min_inliers &&
        observed.translation_sigma <= options_.max_translation_sigma) {
      return frame;
    }
  }
  next_candidate_ += static_cast<std::size_t>(options_.relocalisation_candidates - 1);
  return std::nullopt;
}

TrackResult Tracker::go_on_at_known_place(Frame& frame) {
  motion_.reset(frame.features.header.utime, frame.prediction);
  return finish(frame, TrackingState::relocalised, "found keyframe " + std::to_string(frame.known_place.value));
}

TrackResult Tracker::recover(const FrameFeatures& features, const std::string& why) {
  if (std::optional<Frame> frame = find_known_place(features)) return go_on_at_known_place(*frame);
  lost_ = true;
  state_ = TrackingState::lost;
  return refuse(features.header, why);
}

TrackResult Tracker::begin_anew(Frame& frame) {
  frame.begins_anew = true;
  return finish(frame, TrackingState::rotation_only,
                "one wall was all that was known: the map begins at the predicted pose");
}

TrackResult Tracker::begin_anew(const FrameFeatures& features) {
  const Pose last = motion_.predict(last_measured_utime_).camera_from_world;
  Frame frame{.features = features, .prediction = known_within(last, kUnknown, kUnknown)};
  frame.camera_from_world = last;
  motion_.reset(features.header.utime, known_within(last, kCertain, kCertain));
  return begin_anew(frame);
}

}  // namespace eg::tracking
