#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "common/messages/limits.hpp"

namespace eg::messages {

/// Where a value stands in a message, e.g. points[3].depth. It costs nothing until it is written out: a path only
/// points to its parent, which must outlive it.
class Path {
 public:
  Path() = default;

  [[nodiscard]] Path operator()(const char* member) const { return {this, member, -1}; }
  [[nodiscard]] Path operator()(const char* list, std::size_t index) const {
    return {this, list, static_cast<std::int64_t>(index)};
  }
  [[nodiscard]] std::string to_string() const;

 private:
  Path(const Path* parent, const char* name, std::int64_t index) : parent_(parent), name_(name), index_(index) {}

  const Path* parent_ = nullptr;
  const char* name_ = "";
  std::int64_t index_ = -1;
};

/// Tests decoded values and keeps the first complaint.
class Checker {
 public:
  void finite(const Path& path, double value);
  void positive(const Path& path, double value);
  void not_negative(const Path& path, double value);
  void in_range(const Path& path, std::int64_t value, std::int64_t low, std::int64_t high);
  /// An index into a list of `size`, or -1 for none.
  void index_or_none(const Path& path, std::int64_t value, std::size_t size);

  template <typename Derived>
  void finite(const Path& path, const Eigen::MatrixBase<Derived>& values) {
    require(values.array().isFinite().all(), path, "is not finite");
  }
  /// Positions and distances in metres.
  template <typename Derived>
  void length(const Path& path, const Eigen::MatrixBase<Derived>& values) {
    finite(path, values);
    require(values.cwiseAbs().maxCoeff() <= kMaxLength, path, "is farther than 10 km");
  }
  void length(const Path& path, double value) { length(path, Eigen::Matrix<double, 1, 1>(value)); }
  void pixel(const Path& path, const Eigen::Vector2d& pixel);
  void unit_vector(const Path& path, const Eigen::Vector3d& vector);
  void rotation(const Path& path, const Eigen::Matrix3d& matrix);

  /// Finite, no negative variance, no correlation beyond one: |c_ij|² <= c_ii c_jj, within rounding.
  template <typename Derived>
  void covariance(const Path& path, const Eigen::MatrixBase<Derived>& matrix) {
    finite(path, matrix);
    const double rounding = 1e-9 * matrix.cwiseAbs().maxCoeff();
    const Eigen::Matrix<double, Derived::RowsAtCompileTime, 1> variances = matrix.diagonal().array() + rounding;
    require((variances.array() >= 0).all(), path, "has a negative variance");
    const typename Derived::PlainObject bounds = variances * variances.transpose() * (1 + 1e-6);
    require((matrix.array().square() <= bounds.array()).all(), path, "is no covariance matrix");
  }

  /// Complains about the value at `path` unless `condition` holds; `complaint` follows its name: "is not finite".
  void require(bool condition, const Path& path, std::string_view complaint) {
    if (!condition) complain(path, complaint);
  }

  [[nodiscard]] bool ok() const { return error_.empty(); }
  [[nodiscard]] base::Status status() const;

 private:
  void complain(const Path& path, std::string_view complaint);

  std::string error_;
};

}  // namespace eg::messages
