#include <algorithm>
#include <egraph_msgs/features_t.hpp>

#include "common/messages/codec.hpp"
#include "common/messages/guard.hpp"
#include "common/messages/list.hpp"
#include "common/messages/wire.hpp"
#include "common/messages/wire_direction.hpp"
#include "common/messages/wire_geometry.hpp"

namespace eg::messages {
using features::FrameFeatures;
using features::LineFeature;
using features::PlaneFeature;
using features::PointFeature;
using Wire = egraph_msgs::features_t;

static egraph_msgs::point_t write(const PointFeature& point) {
  egraph_msgs::point_t wire{};
  write_vector(point.pixel, wire.pixel);
  wire.pixel_sigma = point.pixel_sigma;
  wire.depth = point.depth;
  wire.depth_sigma = point.depth_sigma;
  wire.angle = point.angle;
  wire.octave = point.octave;
  wire.track_id = point.track_id;
  std::copy(point.descriptor.begin(), point.descriptor.end(), wire.descriptor);
  return wire;
}

static PointFeature read(const egraph_msgs::point_t& wire, const Path& path, Checker& check) {
  PointFeature point;
  point.pixel = read_vector(wire.pixel);
  point.pixel_sigma = wire.pixel_sigma;
  point.depth = wire.depth;
  point.depth_sigma = wire.depth_sigma;
  point.angle = wire.angle;
  point.octave = wire.octave;
  point.track_id = wire.track_id;
  std::copy(std::begin(wire.descriptor), std::end(wire.descriptor), point.descriptor.begin());

  check.pixel(path("pixel"), point.pixel);
  check.positive(path("pixel_sigma"), point.pixel_sigma);
  check.not_negative(path("depth"), point.depth);
  check.length(path("depth"), point.depth);
  check.not_negative(path("depth_sigma"), point.depth_sigma);
  check.require(!point.has_depth() || point.depth_sigma > 0.0, path("depth_sigma"), "is zero beside a depth");
  check.finite(path("angle"), point.angle);
  check.in_range(path("octave"), point.octave, 0, kMaxPyramidLevel);
  check.in_range(path("track_id"), point.track_id, -1, INT32_MAX);
  return point;
}

static egraph_msgs::line_t write(const LineFeature& line) {
  egraph_msgs::line_t wire{};
  write_vector(line.start_pixel, wire.start_pixel);
  write_vector(line.end_pixel, wire.end_pixel);
  wire.has_depth = static_cast<std::int8_t>(line.has_depth);
  write_vector(line.start, wire.start);
  write_vector(line.end, wire.end);
  write_symmetric(line.start_covariance, wire.start_covariance);
  write_symmetric(line.end_covariance, wire.end_covariance);
  wire.direction = line.direction;
  wire.track_id = line.track_id;
  std::copy(line.descriptor.begin(), line.descriptor.end(), wire.descriptor);
  return wire;
}

static LineFeature read(const egraph_msgs::line_t& wire, const Path& path, Checker& check) {
  LineFeature line;
  line.start_pixel = read_vector(wire.start_pixel);
  line.end_pixel = read_vector(wire.end_pixel);
  line.has_depth = read_bool(wire.has_depth, path("has_depth"), check);
  line.start = read_vector(wire.start);
  line.end = read_vector(wire.end);
  line.start_covariance = read_covariance<3>(wire.start_covariance, path("start_covariance"), check);
  line.end_covariance = read_covariance<3>(wire.end_covariance, path("end_covariance"), check);
  line.direction = wire.direction;
  line.track_id = wire.track_id;
  std::copy(std::begin(wire.descriptor), std::end(wire.descriptor), line.descriptor.begin());

  check.pixel(path("start_pixel"), line.start_pixel);
  check.pixel(path("end_pixel"), line.end_pixel);
  check.require(line.start_pixel != line.end_pixel, path("end_pixel"), "is the start of the line, too");
  check.length(path("start"), line.start);
  check.length(path("end"), line.end);
  check.require(!line.has_depth || line.start != line.end, path("end"), "is the start of the line, too");
  check.in_range(path("track_id"), line.track_id, -1, INT32_MAX);
  return line;
}

static egraph_msgs::hull_point_t write(const Eigen::Vector3d& point) {
  egraph_msgs::hull_point_t wire{};
  write_vector(point, wire.position);
  return wire;
}

static Eigen::Vector3d read(const egraph_msgs::hull_point_t& wire, const Path& path, Checker& check) {
  const Eigen::Vector3d point = read_vector(wire.position);
  check.length(path("position"), point);
  return point;
}

/// Without the hull, which all planes of a message share.
static egraph_msgs::plane_t write(const PlaneFeature& plane) {
  egraph_msgs::plane_t wire{};
  write_vector(plane.plane.normal, wire.normal);
  wire.distance = plane.plane.distance;
  write_symmetric(plane.covariance, wire.covariance);
  write_vector(plane.centroid, wire.centroid);
  wire.support = plane.support;
  wire.hull_size = static_cast<std::int32_t>(plane.hull.size());
  return wire;
}

static PlaneFeature read(const egraph_msgs::plane_t& wire, const Path& path, Checker& check) {
  PlaneFeature plane;
  plane.plane = {read_vector(wire.normal), wire.distance};
  plane.covariance = read_covariance<4>(wire.covariance, path("covariance"), check);
  plane.centroid = read_vector(wire.centroid);
  plane.support = read_count(wire.support, path("support"), check);
  check.unit_vector(path("normal"), plane.plane.normal);
  check.positive(path("distance"), plane.plane.distance);
  check.length(path("distance"), plane.plane.distance);
  check.length(path("centroid"), plane.centroid);
  return plane;
}

/// Deals the message's hull points out to its planes.
static void read_hulls(const Wire& wire, const Path& path, Checker& check, FrameFeatures& frame) {
  const auto points = read_list<Eigen::Vector3d>(wire.hull_points, "hull_points", path, check, read);
  auto next = points.begin();
  for (std::size_t i = 0; i < wire.planes.size(); ++i) {
    const std::int32_t size = wire.planes[i].hull_size;
    const std::int64_t left = std::min<std::int64_t>(points.end() - next, features::kMaxHullPoints);
    check.in_range(path("planes", i)("hull_size"), size, 0, left);
    if (!check.ok()) return;
    frame.planes[i].hull.assign(next, next + size);
    next += size;
  }
  check.require(next == points.end(), path("num_hull_points"), "is not the sum of the hull sizes");
}

/// An index that must be there: whoever has the direction looks its plane or line up.
static void check_source(const Path& path, std::int32_t source, std::size_t size, Checker& check) {
  check.in_range(path, source, 0, static_cast<std::int64_t>(size) - 1);
}

/// The indices between lines, planes and directions.
static void check_references(const FrameFeatures& frame, const Path& path, Checker& check) {
  for (std::size_t i = 0; i < frame.lines.size(); ++i) {
    check.index_or_none(path("lines", i)("direction"), frame.lines[i].direction, frame.directions.size());
  }
  for (std::size_t i = 0; i < frame.directions.size(); ++i) {
    const features::DirectionFeature& direction = frame.directions[i];
    const Path at = path("directions", i);
    switch (direction.kind) {
      case features::DirectionKind::plane_normal:
        check_source(at("source"), direction.source, frame.planes.size(), check);
        break;
      case features::DirectionKind::potential_direction:
        check_source(at("source"), direction.source, frame.lines.size(), check);
        break;
      case features::DirectionKind::vanishing_direction:
        check.index_or_none(at("source"), direction.source, 0);
        break;
    }
  }
}

static base::Result<Wire> decode_features_wire(ByteView bytes) {
  return decode_wire<Wire>(
      bytes,
      {{"num_points", features::kMaxPoints, wire_size<egraph_msgs::point_t>()},
       {"num_lines", features::kMaxLines, wire_size<egraph_msgs::line_t>()},
       {"num_planes", features::kMaxPlanes, wire_size<egraph_msgs::plane_t>()},
       {"num_hull_points", features::kMaxPlanes * features::kMaxHullPoints, wire_size<egraph_msgs::hull_point_t>()},
       {"num_directions", features::kMaxDirections, wire_size<egraph_msgs::direction_t>()}},
      {{"camera_name", kMaxName}});
}

static base::Result<FrameFeatures> decode_features(ByteView bytes) {
  const auto wire = decode_features_wire(bytes);
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  FrameFeatures frame;
  frame.header = read(wire->header, path("header"), check);
  frame.camera = read(wire->camera, wire->camera_name, path("camera"), check);
  check.require(!frame.camera.has_distortion(), path("camera")("distortion"), "is not zero");
  frame.points = read_list<PointFeature>(wire->points, "points", path, check, read);
  frame.lines = read_list<LineFeature>(wire->lines, "lines", path, check, read);
  frame.planes = read_list<PlaneFeature>(wire->planes, "planes", path, check, read);
  frame.directions = read_list<features::DirectionFeature>(wire->directions, "directions", path, check, read);
  read_hulls(*wire, path, check, frame);
  check_references(frame, path, check);
  return checked(std::move(frame), check);
}

Bytes encode(const FrameFeatures& frame) {
  Wire wire{};
  wire.header = write(frame.header);
  wire.camera = write(frame.camera);
  wire.camera_name = printable(frame.camera.name, kMaxName);
  write_list(frame.points, wire.num_points, wire.points, write);
  write_list(frame.lines, wire.num_lines, wire.lines, write);
  write_list(frame.planes, wire.num_planes, wire.planes, write);
  write_list(frame.directions, wire.num_directions, wire.directions, write);
  for (const PlaneFeature& plane : frame.planes) {
    for (const Eigen::Vector3d& point : plane.hull) wire.hull_points.push_back(write(point));
  }
  wire.num_hull_points = static_cast<std::int32_t>(wire.hull_points.size());
  return encode_wire(wire);
}

base::Result<image::FrameHeader> decode_features_header(ByteView bytes) {
  return guarded<image::FrameHeader>([&]() -> base::Result<image::FrameHeader> {
    const auto wire = decode_features_wire(bytes);
    if (!wire) return tl::make_unexpected(wire.error());
    Checker check;
    image::FrameHeader header = read(wire->header, Path{}("header"), check);
    return checked(header, check);
  });
}

template <>
base::Result<FrameFeatures> decode(ByteView bytes) {
  return guarded<FrameFeatures>([&] { return decode_features(bytes); });
}

}  // namespace eg::messages
