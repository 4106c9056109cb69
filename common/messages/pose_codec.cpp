#include <egraph_msgs/pose_correction_t.hpp>
#include <egraph_msgs/pose_estimate_t.hpp>

#include "common/messages/codec.hpp"
#include "common/messages/guard.hpp"
#include "common/messages/list.hpp"
#include "common/messages/wire.hpp"
#include "common/messages/wire_geometry.hpp"
#include "common/messages/wire_graph.hpp"

namespace eg::messages {
using egraph::KeyframeId;
using tracking::PoseCorrection;
using tracking::PoseEstimate;

static base::Result<PoseEstimate> decode_estimate(ByteView bytes) {
  const auto wire = decode_wire<egraph_msgs::pose_estimate_t>(bytes, {}, {{"reason", kMaxText}});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  PoseEstimate pose;
  pose.header = read(wire->header, path("header"), check);
  pose.state = read_enum(wire->state, tracking::TrackingState::relocalised, path("state"), check);
  pose.reason = wire->reason;
  pose.has_pose = read_bool(wire->has_pose, path("has_pose"), check);
  pose.world_from_camera = read(wire->world_from_camera, path("world_from_camera"), check);
  pose.covariance = read_covariance<6>(wire->covariance, path("covariance"), check);
  pose.keyframe = read_optional_id<KeyframeId>(wire->keyframe, path("keyframe"), check);
  pose.rotation_reference = read_optional_id<KeyframeId>(wire->rotation_reference, path("rotation_reference"), check);
  pose.matched_points = read_count(wire->matched_points, path("matched_points"), check);
  pose.matched_lines = read_count(wire->matched_lines, path("matched_lines"), check);
  pose.matched_planes = read_count(wire->matched_planes, path("matched_planes"), check);
  pose.matched_directions = read_count(wire->matched_directions, path("matched_directions"), check);
  pose.corrections = read_counter(wire->corrections, path("corrections"), check);
  return checked(std::move(pose), check);
}

static base::Result<PoseCorrection> decode_correction(ByteView bytes) {
  const auto wire = decode_wire<egraph_msgs::pose_correction_t>(
      bytes, {{"num_entries", kMaxGraphNodes, wire_size<egraph_msgs::corrected_pose_t>()}}, {});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  PoseCorrection correction;
  correction.session = wire->session;
  correction.version = read_counter(wire->version, path("version"), check);
  correction.since = wire->since;
  check.in_range(path("since"), correction.since, 0, correction.version);
  correction.entries = read_list<PoseCorrection::Entry>(wire->entries, "entries", path, check, read);
  return checked(std::move(correction), check);
}

Bytes encode(const PoseEstimate& pose) {
  egraph_msgs::pose_estimate_t wire{};
  wire.header = write(pose.header);
  wire.state = static_cast<std::int8_t>(pose.state);
  wire.has_pose = static_cast<std::int8_t>(pose.has_pose);
  wire.world_from_camera = write(pose.world_from_camera);
  write_symmetric(pose.covariance, wire.covariance);
  wire.keyframe = pose.keyframe.value;
  wire.rotation_reference = pose.rotation_reference.value;
  wire.matched_points = pose.matched_points;
  wire.matched_lines = pose.matched_lines;
  wire.matched_planes = pose.matched_planes;
  wire.matched_directions = pose.matched_directions;
  wire.corrections = pose.corrections;
  wire.reason = printable(pose.reason, kMaxText);
  return encode_wire(wire);
}

Bytes encode(const PoseCorrection& correction) {
  egraph_msgs::pose_correction_t wire{};
  wire.session = correction.session;
  wire.version = correction.version;
  wire.since = correction.since;
  write_list(correction.entries, wire.num_entries, wire.entries, write);
  return encode_wire(wire);
}

template <>
base::Result<PoseEstimate> decode(ByteView bytes) {
  return guarded<PoseEstimate>([&] { return decode_estimate(bytes); });
}

template <>
base::Result<PoseCorrection> decode(ByteView bytes) {
  return guarded<PoseCorrection>([&] { return decode_correction(bytes); });
}

}  // namespace eg::messages
