#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/pose.hpp"
#include "common/image/rgbd_frame.hpp"

namespace eg::mapping {

/// A scene of spheres and axis-aligned boxes, each solid or hollow (seen from inside), with exact depth and distances.
struct AnalyticScene {
  struct Sphere {
    Eigen::Vector3d centre;
    double radius = 0.0;
  };
  struct Box {
    Eigen::Vector3d low, high;
    bool hollow = false;
  };
  std::vector<Sphere> spheres;
  std::vector<Box> boxes;

  /// Parameter of the first point seen along a ray; infinite if there is none.
  [[nodiscard]] double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    double first = std::numeric_limits<double>::infinity();
    const auto offer = [&](double t) {
      if (t > 1e-9) first = std::min(first, t);
    };
    for (const Sphere& sphere : spheres) {
      const Eigen::Vector3d to_centre = sphere.centre - origin;
      const double a = direction.squaredNorm();
      const double b = direction.dot(to_centre);
      const double root = b * b - a * (to_centre.squaredNorm() - sphere.radius * sphere.radius);
      if (root >= 0) offer((b - std::sqrt(root)) / a);
    }
    for (const Box& box : boxes) {
      const Eigen::Array3d to_low = (box.low - origin).array() / direction.array();
      const Eigen::Array3d to_high = (box.high - origin).array() / direction.array();
      const double enter = to_low.min(to_high).maxCoeff();
      const double leave = to_low.max(to_high).minCoeff();
      if (enter <= leave) offer(box.hollow ? leave : enter);
    }
    return first;
  }

  /// Distance of a point from the nearest surface.
  [[nodiscard]] double distance(const Eigen::Vector3d& point) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Sphere& sphere : spheres) {
      nearest = std::min(nearest, std::abs((point - sphere.centre).norm() - sphere.radius));
    }
    for (const Box& box : boxes) {
      const Eigen::Vector3d beyond = (box.low - point).cwiseMax(point - box.high);
      const double outside = beyond.cwiseMax(0.0).norm();
      nearest = std::min(nearest, outside > 0 ? outside : -beyond.maxCoeff());
    }
    return nearest;
  }

  /// What the camera sees; red grows with the pixel's column, green with its row.
  [[nodiscard]] image::RectifiedFrame render(const geometry::CameraModel& camera,
                                             const geometry::Pose& world_from_camera) const {
    image::RectifiedFrame frame{
        {}, camera, cv::Mat(camera.height, camera.width, CV_8UC3), cv::Mat(camera.height, camera.width, CV_32FC1)};
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const double depth = cast(world_from_camera.translation, world_from_camera.rotation * camera.ray({u, v}));
        frame.depth.at<float>(v, u) = std::isfinite(depth) ? static_cast<float>(depth) : 0.0F;
        frame.colour.at<cv::Vec3b>(v, u) = {40, static_cast<std::uint8_t>(255 * v / camera.height),
                                            static_cast<std::uint8_t>(255 * u / camera.width)};
      }
    }
    return frame;
  }
};

inline geometry::CameraModel square_camera(int side, double focal_length) {
  geometry::CameraModel camera;
  camera.width = side;
  camera.height = side;
  camera.fx = focal_length;
  camera.fy = focal_length;
  camera.cx = 0.5 * (side - 1);
  camera.cy = 0.5 * (side - 1);
  camera.depth_units_per_metre = 5000;
  camera.fps = 30;
  return camera;
}

inline geometry::Pose pose_of(double yaw, double pitch, const Eigen::Vector3d& position) {
  return {(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()))
              .toRotationMatrix(),
          position};
}

/// Six views from one place that together see everything around it if the camera sees more than 90 degrees.
inline std::vector<geometry::Pose> views_all_round(const Eigen::Vector3d& position) {
  constexpr double kQuarter = std::numbers::pi / 2;
  return {pose_of(0.1, 0, position),
          pose_of(0.1 + kQuarter, 0, position),
          pose_of(0.1 + 2 * kQuarter, 0, position),
          pose_of(0.1 + 3 * kQuarter, 0, position),
          pose_of(0.1, kQuarter, position),
          pose_of(0.1, -kQuarter, position)};
}

inline AnalyticScene empty_room() { return {{}, {{{-1.5, -1.21, -1.33}, {1.52, 1.2, 1.7}, true}}}; }

}  // namespace eg::mapping
