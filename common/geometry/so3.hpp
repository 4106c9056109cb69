#pragma once

#include <Eigen/Core>

namespace eg::geometry {

/// The matrix [v]x with [v]x w = v × w.
Eigen::Matrix3d hat(const Eigen::Vector3d& v);

/// Rotation by |w| radians about w (Rodrigues).
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& w);

/// The rotation vector (radians, norm at most pi) of a rotation matrix.
Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation);

/// The angle in radians, in [0, pi], between two rotations.
double rotation_angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

/// The rotation nearest to `matrix` in the Frobenius norm.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

/// The smallest rotation that takes unit vector `from` to unit vector `to`.
Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Two unit vectors (columns) that complete the unit vector `direction` to a right-handed orthonormal basis.
Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction);

/// The angle in radians, in [0, pi/2], between two lines through the origin (signs do not matter).
double axial_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace eg::geometry
