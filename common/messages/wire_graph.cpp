#include "common/messages/wire_graph.hpp"

#include "common/messages/wire_geometry.hpp"

namespace eg::messages {

using egraph::KeyframeId;
using egraph::LandmarkId;

egraph_msgs::keyframe_node_t write(const egraph::KeyframeNode& node) {
  egraph_msgs::keyframe_node_t wire{};
  wire.id = node.id.value;
  wire.sequence = node.sequence;
  wire.utime = node.utime;
  wire.world_from_camera = write(node.world_from_camera);
  write_symmetric(node.covariance, wire.covariance);
  return wire;
}

egraph::KeyframeNode read(const egraph_msgs::keyframe_node_t& wire, const Path& path, Checker& check) {
  egraph::KeyframeNode node;
  node.id = read_id<KeyframeId>(wire.id, path("id"), check);
  node.sequence = read_counter(wire.sequence, path("sequence"), check);
  node.utime = read_counter(wire.utime, path("utime"), check);
  node.world_from_camera = read(wire.world_from_camera, path("world_from_camera"), check);
  node.covariance = read_covariance<6>(wire.covariance, path("covariance"), check);
  return node;
}

egraph_msgs::landmark_t write(const egraph::DirectionLandmark& landmark) {
  egraph_msgs::landmark_t wire{};
  wire.id = landmark.id.value;
  wire.kind = static_cast<std::int8_t>(landmark.kind);
  write_vector(landmark.direction, wire.direction);
  write_symmetric(landmark.covariance, wire.covariance);
  wire.observations = landmark.observations;
  wire.first_seen = landmark.first_seen.value;
  wire.last_seen = landmark.last_seen.value;
  return wire;
}

egraph::DirectionLandmark read(const egraph_msgs::landmark_t& wire, const Path& path, Checker& check) {
  egraph::DirectionLandmark landmark;
  landmark.id = read_id<LandmarkId>(wire.id, path("id"), check);
  landmark.kind = read_enum(wire.kind, features::DirectionKind::potential_direction, path("kind"), check);
  landmark.direction = read_vector(wire.direction);
  check.unit_vector(path("direction"), landmark.direction);
  landmark.covariance = read_covariance<3>(wire.covariance, path("covariance"), check);
  landmark.observations = read_count(wire.observations, path("observations"), check);
  landmark.first_seen = read_optional_id<KeyframeId>(wire.first_seen, path("first_seen"), check);
  landmark.last_seen = read_optional_id<KeyframeId>(wire.last_seen, path("last_seen"), check);
  return landmark;
}

egraph_msgs::observation_t write(const egraph::Observation& observation) {
  egraph_msgs::observation_t wire{};
  wire.keyframe = observation.keyframe.value;
  wire.landmark = observation.landmark.value;
  write_vector(observation.direction_in_camera, wire.direction_in_camera);
  write_symmetric(observation.covariance, wire.covariance);
  return wire;
}

egraph::Observation read(const egraph_msgs::observation_t& wire, const Path& path, Checker& check) {
  egraph::Observation observation;
  observation.keyframe = read_id<KeyframeId>(wire.keyframe, path("keyframe"), check);
  observation.landmark = read_id<LandmarkId>(wire.landmark, path("landmark"), check);
  observation.direction_in_camera = read_vector(wire.direction_in_camera);
  check.unit_vector(path("direction_in_camera"), observation.direction_in_camera);
  observation.covariance = read_covariance<3>(wire.covariance, path("covariance"), check);
  return observation;
}

egraph_msgs::relative_pose_t write(const egraph::RelativePose& relative) {
  egraph_msgs::relative_pose_t wire{};
  wire.first = relative.first.value;
  wire.second = relative.second.value;
  wire.first_from_second = write(relative.first_from_second);
  write_symmetric(relative.covariance, wire.covariance);
  return wire;
}

egraph::RelativePose read(const egraph_msgs::relative_pose_t& wire, const Path& path, Checker& check) {
  egraph::RelativePose relative;
  relative.first = read_id<KeyframeId>(wire.first, path("first"), check);
  relative.second = read_id<KeyframeId>(wire.second, path("second"), check);
  check.require(relative.first != relative.second, path("second"), "is the same keyframe as the first");
  relative.first_from_second = read(wire.first_from_second, path("first_from_second"), check);
  relative.covariance = read_covariance<6>(wire.covariance, path("covariance"), check);
  return relative;
}

egraph_msgs::corrected_pose_t write(const egraph::CorrectedPose& corrected) {
  egraph_msgs::corrected_pose_t wire{};
  wire.keyframe = corrected.keyframe.value;
  wire.world_from_camera = write(corrected.world_from_camera);
  return wire;
}

egraph::CorrectedPose read(const egraph_msgs::corrected_pose_t& wire, const Path& path, Checker& check) {
  return {read_id<KeyframeId>(wire.keyframe, path("keyframe"), check),
          read(wire.world_from_camera, path("world_from_camera"), check)};
}

}  // namespace eg::messages
