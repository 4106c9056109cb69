#pragma once

#include <Eigen/Core>
#include <egraph_msgs/camera_t.hpp>
#include <egraph_msgs/frame_header_t.hpp>
#include <egraph_msgs/pose_t.hpp>
#include <string>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/pose.hpp"
#include "common/image/rgbd_frame.hpp"
#include "common/messages/checker.hpp"
#include "common/messages/limits.hpp"

/// The parts that many messages share. write() makes the LCM class of a domain type; read() makes the domain type and
/// tells `check` what is wrong with it.
namespace eg::messages {

egraph_msgs::frame_header_t write(const image::FrameHeader& header);
egraph_msgs::camera_t write(const geometry::CameraModel& camera);
egraph_msgs::pose_t write(const geometry::Pose& pose);

image::FrameHeader read(const egraph_msgs::frame_header_t& wire, const Path& path, Checker& check);
geometry::CameraModel read(const egraph_msgs::camera_t& wire, const std::string& name, const Path& path,
                           Checker& check);
geometry::Pose read(const egraph_msgs::pose_t& wire, const Path& path, Checker& check);

/// A sequence number, version or time: from 0, far from overflow.
inline std::int64_t read_counter(std::int64_t value, const Path& path, Checker& check) {
  check.in_range(path, value, 0, kMaxCounter);
  return value;
}

/// A size or number of things.
inline std::int32_t read_count(std::int32_t value, const Path& path, Checker& check) {
  check.in_range(path, value, 0, INT32_MAX);
  return value;
}

inline bool read_bool(std::int8_t value, const Path& path, Checker& check) {
  check.in_range(path, value, 0, 1);
  return value != 0;
}

/// An enumeration whose values are counted from 0 to `last`.
template <typename Enum>
Enum read_enum(std::int8_t value, Enum last, const Path& path, Checker& check) {
  check.in_range(path, value, 0, static_cast<std::int64_t>(last));
  return static_cast<Enum>(value);
}

/// An identity that must be there.
template <typename Id>
Id read_id(std::int32_t value, const Path& path, Checker& check) {
  check.in_range(path, value, 0, kMaxIdentity);
  return Id{value};
}

/// An identity, or -1 for none.
template <typename Id>
Id read_optional_id(std::int32_t value, const Path& path, Checker& check) {
  check.in_range(path, value, -1, kMaxIdentity);
  return Id{value};
}

template <int N>
void write_vector(const Eigen::Matrix<double, N, 1>& vector, double (&wire)[N]) {
  for (int i = 0; i < N; ++i) wire[i] = vector[i];
}

template <int N>
Eigen::Matrix<double, N, 1> read_vector(const double (&wire)[N]) {
  return Eigen::Map<const Eigen::Matrix<double, N, 1>>(wire);
}

/// The upper triangle, row by row: what travels is symmetric by construction.
template <int N, int Size>
void write_symmetric(const Eigen::Matrix<double, N, N>& matrix, double (&wire)[Size]) {
  static_assert(Size == N * (N + 1) / 2);
  int i = 0;
  for (int row = 0; row < N; ++row) {
    for (int column = row; column < N; ++column) wire[i++] = matrix(row, column);
  }
}

template <int N, int Size>
Eigen::Matrix<double, N, N> read_covariance(const double (&wire)[Size], const Path& path, Checker& check) {
  static_assert(Size == N * (N + 1) / 2);
  Eigen::Matrix<double, N, N> matrix;
  int i = 0;
  for (int row = 0; row < N; ++row) {
    for (int column = row; column < N; ++column) matrix(row, column) = matrix(column, row) = wire[i++];
  }
  check.covariance(path, matrix);
  return matrix;
}

}  // namespace eg::messages
