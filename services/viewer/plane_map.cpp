#include "services/viewer/plane_map.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "services/viewer/arrays.hpp"
#include "services/viewer/packet.hpp"

namespace eg::services {
namespace {

const double kSameNormal = std::cos(0.12);  // 7 degrees: small patches tilt
constexpr double kSameDistance = 0.05;      // metres
constexpr float kTouching = 0.2F;           // metres between hulls of one surface, e.g. on both sides of a chair
constexpr std::size_t kMaxObservations = 100'000;
constexpr std::size_t kMaxPlanes = 500;

/// Coordinates on a plane.
struct PlaneAxes {
  explicit PlaneAxes(const geometry::Plane& plane) {
    origin = -plane.distance * plane.normal;
    u = plane.normal.unitOrthogonal();
    v = plane.normal.cross(u);
  }
  [[nodiscard]] std::vector<cv::Point2f> flatten(const std::vector<Eigen::Vector3d>& points) const {
    std::vector<cv::Point2f> flat;
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d offset = point - origin;
      flat.emplace_back(static_cast<float>(u.dot(offset)), static_cast<float>(v.dot(offset)));
    }
    return flat;
  }
  [[nodiscard]] Eigen::Vector3d lift(const cv::Point2f& point) const {
    return origin + static_cast<double>(point.x) * u + static_cast<double>(point.y) * v;
  }

  Eigen::Vector3d origin, u, v;
};

/// Whether every point of the hull is near the plane.
bool lies_in(const std::vector<Eigen::Vector3d>& hull, const geometry::Plane& plane) {
  return std::all_of(hull.begin(), hull.end(), [&](const Eigen::Vector3d& point) {
    return std::abs(plane.signed_distance(point)) < kSameDistance;
  });
}

bool touches(const std::vector<cv::Point2f>& hull, const std::vector<cv::Point2f>& points) {
  return std::any_of(points.begin(), points.end(),
                     [&](const cv::Point2f& point) { return cv::pointPolygonTest(hull, point, true) > -kTouching; });
}

MapPlane in_world(const features::PlaneFeature& feature, const geometry::Pose& world_from_camera) {
  MapPlane plane;
  plane.plane = geometry::transform(world_from_camera, feature.plane);
  plane.support = feature.support;
  for (const Eigen::Vector3d& corner : feature.hull) plane.hull.push_back(world_from_camera * corner);
  return plane;
}

/// Puts the plane into the list, and joins what it connects.
void insert(std::vector<MapPlane>& planes, MapPlane plane) {
  for (std::size_t i = 0; i < planes.size();) {
    if (!join(plane, planes[i])) {
      ++i;
      continue;
    }
    planes.erase(planes.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;  // the larger plane may touch others now
  }
  if (planes.size() < kMaxPlanes) planes.push_back(std::move(plane));
}

}  // namespace

bool join(MapPlane& plane, const MapPlane& other) {
  if (plane.plane.normal.dot(other.plane.normal) < kSameNormal) return false;
  const MapPlane& larger = plane.support >= other.support ? plane : other;
  const MapPlane& smaller = plane.support >= other.support ? other : plane;
  if (!lies_in(smaller.hull, larger.plane)) return false;
  const PlaneAxes axes(larger.plane);
  std::vector<cv::Point2f> corners = axes.flatten(larger.hull);
  const std::vector<cv::Point2f> added = axes.flatten(smaller.hull);
  if (!touches(corners, added) && !touches(added, corners)) return false;

  MapPlane joined;
  joined.support = plane.support + other.support;
  joined.plane.normal = (plane.support * plane.plane.normal + other.support * other.plane.normal).normalized();
  joined.plane.distance =
      (plane.support * plane.plane.distance + other.support * other.plane.distance) / joined.support;
  corners.insert(corners.end(), added.begin(), added.end());
  std::vector<cv::Point2f> hull;
  cv::convexHull(corners, hull);
  for (const cv::Point2f& corner : hull) {
    const Eigen::Vector3d point = axes.lift(corner);
    joined.hull.push_back(point - joined.plane.signed_distance(point) * joined.plane.normal);
  }
  plane = std::move(joined);
  return true;
}

void PlaneMap::add(egraph::KeyframeId keyframe, const std::vector<features::PlaneFeature>& planes) {
  for (const features::PlaneFeature& plane : planes) {
    if (plane.hull.size() >= 3 && observations_.size() < kMaxObservations) observations_.push_back({keyframe, plane});
  }
}

void PlaneMap::join_new_observations(const GraphView& graph) {
  if (corrections_ != graph.corrections()) {
    corrections_ = graph.corrections();
    planes_.clear();
    joined_ = 0;
  }
  for (; joined_ < observations_.size(); ++joined_) {
    const Observation& observation = observations_[joined_];
    const geometry::Pose* pose = graph.find_pose(observation.keyframe);
    if (pose != nullptr) insert(planes_, in_world(observation.plane, *pose));
  }
}

bool PlaneMap::put(Board& board, const GraphView& graph) {
  join_new_observations(graph);
  std::vector<std::int32_t> sizes, numbers;
  std::vector<float> corners, normals, support;
  for (const MapPlane& plane : planes_) {
    sizes.push_back(static_cast<std::int32_t>(plane.hull.size()));
    numbers.push_back(graph.colours().of(plane.plane.normal));
    append(normals, plane.plane.normal);
    support.push_back(static_cast<float>(plane.support));
    for (const Eigen::Vector3d& corner : plane.hull) append(corners, corner);
  }
  return board.put("planes", Packet("planes")
                                 .array("sizes", sizes)
                                 .array("colours", numbers)
                                 .array("corners", corners)
                                 .array("normals", normals)
                                 .array("support", support)
                                 .bytes());
}

}  // namespace eg::services
