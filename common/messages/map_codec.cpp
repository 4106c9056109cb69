#include <egraph_msgs/map_keyframe_t.hpp>
#include <egraph_msgs/map_landmarks_t.hpp>

#include "common/messages/codec.hpp"
#include "common/messages/guard.hpp"
#include "common/messages/list.hpp"
#include "common/messages/wire.hpp"
#include "common/messages/wire_direction.hpp"
#include "common/messages/wire_geometry.hpp"

namespace eg::messages {
namespace {

using tracking::KeyframeLinks;
using tracking::LandmarkPositions;

template <typename Id>
egraph_msgs::map_match_t write_match(const tracking::Match<Id>& match) {
  egraph_msgs::map_match_t wire{};
  wire.feature = match.feature;
  wire.landmark = match.id.value;
  return wire;
}

template <typename Id>
tracking::Match<Id> read_match(const egraph_msgs::map_match_t& wire, const Path& path, Checker& check) {
  check.in_range(path("feature"), wire.feature, 0, INT32_MAX);
  return {wire.feature, read_id<Id>(wire.landmark, path("landmark"), check)};
}

egraph_msgs::map_association_t write_association(const egraph::Association& association) {
  egraph_msgs::map_association_t wire{};
  wire.feature = static_cast<std::int32_t>(association.feature);
  wire.landmark = association.landmark.value;
  wire.sign = association.sign;
  wire.chi2 = association.chi2;
  wire.outlier_chi2 = association.outlier_chi2;
  return wire;
}

egraph::Association read_association(const egraph_msgs::map_association_t& wire, const Path& path, Checker& check) {
  check.in_range(path("feature"), wire.feature, 0, features::kMaxDirections - 1);
  check.require(wire.sign == 1.0 || wire.sign == -1.0, path("sign"), "is neither 1 nor -1");
  check.not_negative(path("chi2"), wire.chi2);
  check.not_negative(path("outlier_chi2"), wire.outlier_chi2);
  return {static_cast<std::size_t>(wire.feature), read_id<egraph::LandmarkId>(wire.landmark, path("landmark"), check),
          wire.sign, wire.chi2, wire.outlier_chi2};
}

egraph_msgs::map_point_t write_point(const LandmarkPositions::Point& point) {
  egraph_msgs::map_point_t wire{};
  write_vector(point.position, wire.position);
  wire.alive = static_cast<std::int8_t>(point.alive);
  return wire;
}

LandmarkPositions::Point read_point(const egraph_msgs::map_point_t& wire, const Path& path, Checker& check) {
  const LandmarkPositions::Point point{read_vector(wire.position), read_bool(wire.alive, path("alive"), check)};
  check.finite(path("position"), point.position);
  return point;
}

egraph_msgs::map_line_t write_line(const LandmarkPositions::Line& line) {
  egraph_msgs::map_line_t wire{};
  write_vector(line.start, wire.start);
  write_vector(line.end, wire.end);
  wire.alive = static_cast<std::int8_t>(line.alive);
  return wire;
}

LandmarkPositions::Line read_line(const egraph_msgs::map_line_t& wire, const Path& path, Checker& check) {
  const LandmarkPositions::Line line{read_vector(wire.start), read_vector(wire.end),
                                     read_bool(wire.alive, path("alive"), check)};
  check.finite(path("start"), line.start);
  check.finite(path("end"), line.end);
  return line;
}

egraph_msgs::map_plane_t write_plane(const geometry::Plane& plane) {
  egraph_msgs::map_plane_t wire{};
  write_vector(plane.normal, wire.normal);
  wire.distance = plane.distance;
  return wire;
}

geometry::Plane read_plane(const egraph_msgs::map_plane_t& wire, const Path& path, Checker& check) {
  const geometry::Plane plane{read_vector(wire.normal), wire.distance};
  check.unit_vector(path("normal"), plane.normal);
  check.finite(path("distance"), plane.distance);
  return plane;
}

base::Result<KeyframeLinks> decode_links(ByteView bytes) {
  const std::size_t match = wire_size<egraph_msgs::map_match_t>();
  const auto wire = decode_wire<egraph_msgs::map_keyframe_t>(
      bytes,
      {{"num_points", features::kMaxPoints, match},
       {"num_lines", features::kMaxLines, match},
       {"num_planes", features::kMaxPlanes, match},
       {"num_directions", kMaxAssociations, wire_size<egraph_msgs::map_association_t>()}},
      {});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  KeyframeLinks links;
  links.world_from_camera = read(wire->world_from_camera, path("world_from_camera"), check);
  links.matches.points =
      read_list<tracking::PointMatch>(wire->points, "points", path, check, read_match<tracking::PointId>);
  links.matches.lines = read_list<tracking::LineMatch>(wire->lines, "lines", path, check, read_match<tracking::LineId>);
  links.matches.planes =
      read_list<tracking::PlaneMatch>(wire->planes, "planes", path, check, read_match<tracking::PlaneId>);
  links.directions = read_list<egraph::Association>(wire->directions, "directions", path, check, read_association);
  return checked(std::move(links), check);
}

base::Result<LandmarkPositions> decode_landmarks(ByteView bytes) {
  const auto wire = decode_wire<egraph_msgs::map_landmarks_t>(
      bytes,
      {{"num_points", kMaxMapLandmarks, wire_size<egraph_msgs::map_point_t>()},
       {"num_lines", kMaxMapLandmarks, wire_size<egraph_msgs::map_line_t>()},
       {"num_planes", kMaxMapLandmarks, wire_size<egraph_msgs::map_plane_t>()}},
      {});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  LandmarkPositions landmarks;
  landmarks.points = read_list<LandmarkPositions::Point>(wire->points, "points", path, check, read_point);
  landmarks.lines = read_list<LandmarkPositions::Line>(wire->lines, "lines", path, check, read_line);
  landmarks.planes = read_list<geometry::Plane>(wire->planes, "planes", path, check, read_plane);
  return checked(std::move(landmarks), check);
}

}  // namespace

Bytes encode(const KeyframeLinks& links) {
  egraph_msgs::map_keyframe_t wire{};
  wire.world_from_camera = write(links.world_from_camera);
  write_list(links.matches.points, wire.num_points, wire.points, write_match<tracking::PointId>);
  write_list(links.matches.lines, wire.num_lines, wire.lines, write_match<tracking::LineId>);
  write_list(links.matches.planes, wire.num_planes, wire.planes, write_match<tracking::PlaneId>);
  write_list(links.directions, wire.num_directions, wire.directions, write_association);
  return encode_wire(wire);
}

Bytes encode(const LandmarkPositions& landmarks) {
  egraph_msgs::map_landmarks_t wire{};
  write_list(landmarks.points, wire.num_points, wire.points, write_point);
  write_list(landmarks.lines, wire.num_lines, wire.lines, write_line);
  write_list(landmarks.planes, wire.num_planes, wire.planes, write_plane);
  return encode_wire(wire);
}

template <>
base::Result<KeyframeLinks> decode(ByteView bytes) {
  return guarded<KeyframeLinks>([&] { return decode_links(bytes); });
}

template <>
base::Result<LandmarkPositions> decode(ByteView bytes) {
  return guarded<LandmarkPositions>([&] { return decode_landmarks(bytes); });
}

}  // namespace eg::messages
