#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/pose.hpp"

/// Vectors and poses as rows of numbers, as packets carry them.
namespace eg::services {

template <typename Vector>
void append(std::vector<float>& numbers, const Vector& vector) {
  for (Eigen::Index i = 0; i < vector.size(); ++i) numbers.push_back(static_cast<float>(vector[i]));
}

/// Twelve numbers: the rotation matrix row by row, then the translation.
inline void append_pose(std::vector<float>& numbers, const geometry::Pose& pose) {
  for (int row = 0; row < 3; ++row) append(numbers, pose.rotation.row(row));
  append(numbers, pose.translation);
}

}  // namespace eg::services
