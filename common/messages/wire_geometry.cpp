#include "common/messages/wire_geometry.hpp"

#include <algorithm>

namespace eg::messages {

egraph_msgs::frame_header_t write(const image::FrameHeader& header) {
  egraph_msgs::frame_header_t wire{};
  wire.session = header.session;
  wire.sequence = header.sequence;
  wire.utime = header.utime;
  return wire;
}

image::FrameHeader read(const egraph_msgs::frame_header_t& wire, const Path& path, Checker& check) {
  return {wire.session, read_counter(wire.sequence, path("sequence"), check),
          read_counter(wire.utime, path("utime"), check)};
}

egraph_msgs::camera_t write(const geometry::CameraModel& camera) {
  egraph_msgs::camera_t wire{};
  wire.width = camera.width;
  wire.height = camera.height;
  wire.fx = camera.fx;
  wire.fy = camera.fy;
  wire.cx = camera.cx;
  wire.cy = camera.cy;
  std::copy(camera.distortion.begin(), camera.distortion.end(), wire.distortion);
  wire.depth_units_per_metre = camera.depth_units_per_metre;
  wire.fps = camera.fps;
  return wire;
}

geometry::CameraModel read(const egraph_msgs::camera_t& wire, const std::string& name, const Path& path,
                           Checker& check) {
  geometry::CameraModel camera{name, wire.width, wire.height, wire.fx, wire.fy, wire.cx, wire.cy, {}, 0.0, 0.0};
  std::copy(std::begin(wire.distortion), std::end(wire.distortion), camera.distortion.begin());
  camera.depth_units_per_metre = wire.depth_units_per_metre;
  camera.fps = wire.fps;
  if (const auto status = geometry::validate(camera); !status) {
    check.require(false, path, "is wrong: " + status.error().message);
  }
  check.require(std::int64_t{camera.width} * camera.height <= kMaxImagePixels, path, "has too many pixels");
  return camera;
}

egraph_msgs::pose_t write(const geometry::Pose& pose) {
  egraph_msgs::pose_t wire{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) wire.rotation[3 * row + column] = pose.rotation(row, column);
  }
  write_vector(pose.translation, wire.translation);
  return wire;
}

geometry::Pose read(const egraph_msgs::pose_t& wire, const Path& path, Checker& check) {
  const geometry::Pose pose{Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(wire.rotation),
                            read_vector(wire.translation)};
  check.rotation(path("rotation"), pose.rotation);
  check.length(path("translation"), pose.translation);
  return pose;
}

}  // namespace eg::messages
