#include <cmath>
#include <egraph_msgs/keyframe_t.hpp>

#include "common/messages/codec.hpp"
#include "common/messages/guard.hpp"
#include "common/messages/list.hpp"
#include "common/messages/wire.hpp"
#include "common/messages/wire_direction.hpp"
#include "common/messages/wire_geometry.hpp"
#include "common/messages/wire_graph.hpp"

namespace eg::messages {
namespace {

using egraph::Keyframe;

/// Every plane has a distance; what is no plane may say NaN.
void check_plane_distances(const Keyframe& keyframe, const Path& path, Checker& check) {
  for (std::size_t i = 0; i < keyframe.directions.size(); ++i) {
    const double distance = keyframe.plane_distances[i];
    const bool is_plane = keyframe.directions[i].kind == features::DirectionKind::plane_normal;
    if (is_plane || !std::isnan(distance)) check.finite(path("plane_distances", i), distance);
  }
}

base::Result<Keyframe> decode_keyframe(ByteView bytes) {
  const std::size_t direction_and_distance = wire_size<egraph_msgs::direction_t>() + sizeof(double);
  const auto wire = decode_wire<egraph_msgs::keyframe_t>(
      bytes,
      {{"num_directions", features::kMaxDirections, direction_and_distance},
       {"num_covisible", kMaxGraphNodes, wire_size<egraph_msgs::covisibility_t>()},
       {"num_relative_poses", kMaxRelativePoses, wire_size<egraph_msgs::relative_pose_t>()},
       {"num_moved", kMaxGraphNodes, wire_size<egraph_msgs::corrected_pose_t>()}},
      {});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  Keyframe keyframe;
  keyframe.header = read(wire->header, path("header"), check);
  keyframe.id = read_id<egraph::KeyframeId>(wire->id, path("id"), check);
  keyframe.world_from_camera = read(wire->world_from_camera, path("world_from_camera"), check);
  keyframe.covariance = read_covariance<6>(wire->covariance, path("covariance"), check);
  keyframe.directions = read_list<features::DirectionFeature>(wire->directions, "directions", path, check, read);
  keyframe.plane_distances = wire->plane_distances;
  keyframe.covisible = read_list<egraph::Covisibility>(wire->covisible, "covisible", path, check, read);
  keyframe.relative_poses = read_list<egraph::RelativePose>(wire->relative_poses, "relative_poses", path, check, read);
  keyframe.moved = read_list<egraph::CorrectedPose>(wire->moved, "moved", path, check, read);
  check_plane_distances(keyframe, path, check);
  return checked(std::move(keyframe), check);
}

}  // namespace

Bytes encode(const Keyframe& keyframe) {
  EG_CHECK(keyframe.plane_distances.size() == keyframe.directions.size(), "a keyframe has one distance per direction");
  egraph_msgs::keyframe_t wire{};
  wire.header = write(keyframe.header);
  wire.id = keyframe.id.value;
  wire.world_from_camera = write(keyframe.world_from_camera);
  write_symmetric(keyframe.covariance, wire.covariance);
  write_list(keyframe.directions, wire.num_directions, wire.directions, write);
  wire.plane_distances = keyframe.plane_distances;
  write_list(keyframe.covisible, wire.num_covisible, wire.covisible, write);
  write_list(keyframe.relative_poses, wire.num_relative_poses, wire.relative_poses, write);
  write_list(keyframe.moved, wire.num_moved, wire.moved, write);
  return encode_wire(wire);
}

template <>
base::Result<Keyframe> decode(ByteView bytes) {
  return guarded<Keyframe>([&] { return decode_keyframe(bytes); });
}

}  // namespace eg::messages
