#include "common/messages/checker.hpp"

#include <Eigen/LU>
#include <cmath>

namespace eg::messages {
namespace {

// How far unit vectors and rotations may be from exact: what rounding does to a long product of rotations.
constexpr double kUnitTolerance = 1e-6;

}  // namespace

std::string Path::to_string() const {
  std::string path = parent_ != nullptr ? parent_->to_string() : "";
  if (!path.empty()) path += '.';
  path += name_;
  if (index_ >= 0) path += '[' + std::to_string(index_) + ']';
  return path;
}

void Checker::finite(const Path& path, double value) { require(std::isfinite(value), path, "is not finite"); }

void Checker::positive(const Path& path, double value) {
  finite(path, value);
  require(value > 0, path, "is not positive");
}

void Checker::not_negative(const Path& path, double value) {
  finite(path, value);
  require(value >= 0, path, "is negative");
}

void Checker::in_range(const Path& path, std::int64_t value, std::int64_t low, std::int64_t high) {
  if (value >= low && value <= high) return;
  complain(path,
           "is " + std::to_string(value) + ", not in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
}

void Checker::index_or_none(const Path& path, std::int64_t value, std::size_t size) {
  in_range(path, value, -1, static_cast<std::int64_t>(size) - 1);
}

void Checker::pixel(const Path& path, const Eigen::Vector2d& pixel) {
  finite(path, pixel);
  require(pixel.cwiseAbs().maxCoeff() <= kMaxPixel, path, "is far outside any image");
}

void Checker::unit_vector(const Path& path, const Eigen::Vector3d& vector) {
  finite(path, vector);
  require(std::abs(vector.norm() - 1) <= kUnitTolerance, path, "is no unit vector");
}

void Checker::rotation(const Path& path, const Eigen::Matrix3d& matrix) {
  finite(path, matrix);
  const Eigen::Matrix3d difference = matrix.transpose() * matrix - Eigen::Matrix3d::Identity();
  require(difference.cwiseAbs().maxCoeff() <= kUnitTolerance && matrix.determinant() > 0, path, "is no rotation");
}

base::Status Checker::status() const {
  if (!ok()) return base::fail(error_);
  return {};
}

void Checker::complain(const Path& path, std::string_view complaint) {
  if (ok()) error_ = "field '" + path.to_string() + "' " + std::string(complaint);
}

}  // namespace eg::messages
