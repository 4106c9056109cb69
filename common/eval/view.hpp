#pragma once

#include <Eigen/Core>
#include <opencv2/core/types.hpp>
#include <span>

namespace eg::eval {

/// Where a picture of a scene is taken from: without perspective, so that lengths compare all over it.
class OrthographicView {
 public:
  /// Looks along `ahead` turned by `azimuth` about `up` and down by `elevation` (radians). In a `mirrored` world, whose
  /// coordinates are left-handed (docs/frames.md), left and right are swapped to show the room as it is.
  OrthographicView(const Eigen::Vector3d& up, const Eigen::Vector3d& ahead, double azimuth, double elevation,
                   bool mirrored);
  /// Chooses scale and centre so that the points fill the rectangle: all `paths`, and the `surface` but for up to 1 %
  /// of it at each side that lies far out.
  void fit(std::span<const Eigen::Vector3d> surface, std::span<const Eigen::Vector3d> paths, const cv::Rect& rectangle);

  [[nodiscard]] cv::Point2d pixel(const Eigen::Vector3d& point) const;
  /// Distance along the line of sight, metres, from anywhere.
  [[nodiscard]] double depth(const Eigen::Vector3d& point) const { return forward_.dot(point); }
  [[nodiscard]] const Eigen::Vector3d& forward() const { return forward_; }
  [[nodiscard]] double pixels_per_metre() const { return scale_; }

 private:
  struct Interval {
    double low, high;
  };
  [[nodiscard]] static Interval extent(std::span<const Eigen::Vector3d> surface, std::span<const Eigen::Vector3d> paths,
                                       const Eigen::Vector3d& axis);

  Eigen::Vector3d right_, down_, forward_;
  double scale_ = 1.0;
  cv::Point2d offset_{0.0, 0.0};
};

}  // namespace eg::eval
