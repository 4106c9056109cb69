#include "tests/support/feature_world.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "common/geometry/depth_noise.hpp"
#include "common/geometry/so3.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::test {
namespace {

using features::DirectionKind;
using features::FrameFeatures;
using geometry::CameraModel;
using geometry::Pose;

constexpr double kNearest = 0.3;       // metres
constexpr double kFurthest = 6.0;      // metres
constexpr double kPyramidScale = 1.2;  // between two octaves
constexpr double kOctaveRange = 3.0;   // metres from which a corner is found on octave 0
constexpr int kRayStep = 16;           // pixels between the rays that find the walls
constexpr int kMinRays = 25;           // fewer are no plane: 25 * 16 * 16 = 6400 pixels
constexpr double kMinLinePixels = 30.0;
constexpr double kParallel = 1e-6;  // radians

features::Descriptor random_descriptor(base::Random& random) {
  features::Descriptor descriptor;
  for (std::uint8_t& byte : descriptor) byte = static_cast<std::uint8_t>(random.index(256));
  return descriptor;
}

features::Descriptor seen_again(features::Descriptor descriptor, double flip, base::Random& random) {
  for (std::uint8_t& byte : descriptor) {
    for (int bit = 0; bit < 8; ++bit) {
      if (random.uniform() < flip) byte = static_cast<std::uint8_t>(byte ^ (1 << bit));
    }
  }
  return descriptor;
}

/// Normal noise, or none.
class Noise {
 public:
  Noise(const SensorNoise& noise, base::Random& random) : disturb_(noise.disturb ? 1.0 : 0.0), random_(random) {}
  double operator()(double sigma) { return disturb_ * sigma * random_.normal(); }
  Eigen::Vector3d vector(double sigma) { return normal_vector(random_, disturb_ * sigma); }
  Eigen::Vector3d direction(const Eigen::Vector3d& d, double sigma) {
    return disturbed_direction(d, disturb_ * sigma, random_);
  }

 private:
  double disturb_;
  base::Random& random_;
};

void see_points(const FeatureWorld& world, const Pose& camera_from_world, const SensorNoise& sensor,
                base::Random& random, FrameFeatures& frame) {
  Noise noise(sensor, random);
  for (std::size_t i = 0; i < world.corners.size(); ++i) {
    const WorldCorner& corner = world.corners[i];
    const Eigen::Vector3d point = camera_from_world * corner.position;
    if (point.z() < kNearest || point.z() > kFurthest || !frame.camera.contains(frame.camera.project(point))) continue;
    if (sensor.disturb && random.uniform() < sensor.missing) continue;
    features::PointFeature feature;
    feature.octave = std::clamp(
        static_cast<int>(std::lround(std::log(kOctaveRange / point.norm()) / std::log(kPyramidScale))), 0, 7);
    feature.pixel_sigma = sensor.pixel * std::pow(kPyramidScale, feature.octave);
    feature.pixel =
        frame.camera.project(point) + Eigen::Vector2d(noise(feature.pixel_sigma), noise(feature.pixel_sigma));
    feature.depth_sigma = geometry::depth_sigma(point.z());
    feature.depth = point.z() + noise(feature.depth_sigma);
    feature.descriptor =
        sensor.disturb ? seen_again(corner.descriptor, sensor.descriptor_flip, random) : corner.descriptor;
    if (sensor.identities) feature.track_id = static_cast<std::int32_t>(i);
    if (frame.camera.contains(feature.pixel)) frame.points.push_back(feature);
  }
}

/// The part of a segment within one half space of the camera frame: normal · p >= offset.
std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> clip(Eigen::Vector3d a, Eigen::Vector3d b,
                                                                const Eigen::Vector3d& normal, double offset) {
  const double at_a = normal.dot(a) - offset;
  const double at_b = normal.dot(b) - offset;
  if (at_a < 0 && at_b < 0) return std::nullopt;
  if (at_a < 0) a = b + at_b / (at_b - at_a) * (a - b);
  if (at_b < 0) b = a + at_a / (at_a - at_b) * (b - a);
  return std::pair{a, b};
}

/// The part of a segment that the camera sees.
std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> clip_to_view(const Eigen::Vector3d& a,
                                                                        const Eigen::Vector3d& b,
                                                                        const CameraModel& camera) {
  auto part = clip(a, b, Eigen::Vector3d::UnitZ(), kNearest);
  if (part) part = clip(part->first, part->second, -Eigen::Vector3d::UnitZ(), -kFurthest);
  const Eigen::Vector2d corners[] = {
      {0, 0}, {camera.width - 1.0, 0}, {camera.width - 1.0, camera.height - 1.0}, {0, camera.height - 1.0}};
  for (int side = 0; side < 4 && part; ++side) {
    Eigen::Vector3d normal = camera.ray(corners[side]).cross(camera.ray(corners[(side + 1) % 4]));
    if (normal.z() < 0) normal = -normal;
    part = clip(part->first, part->second, normal.normalized(), 0.0);
  }
  return part;
}

Eigen::Vector2d across(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = (b - a).normalized();
  return {-along.y(), along.x()};
}

/// Returns, for each line of the frame, the world's line that it shows.
std::vector<std::size_t> see_lines(const FeatureWorld& world, const Pose& camera_from_world, const SensorNoise& sensor,
                                   base::Random& random, FrameFeatures& frame) {
  Noise noise(sensor, random);
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < world.lines.size(); ++i) {
    const auto part =
        clip_to_view(camera_from_world * world.lines[i].start, camera_from_world * world.lines[i].end, frame.camera);
    if (!part) continue;
    auto [start, end] = *part;
    if (random.index(2) == 0) std::swap(start, end);  // a detector knows no first end
    features::LineFeature line;
    line.start_pixel = frame.camera.project(start);
    line.end_pixel = frame.camera.project(end);
    if (line.length_pixels() < kMinLinePixels) continue;
    const Eigen::Vector2d aside = across(line.start_pixel, line.end_pixel);
    line.start_pixel += noise(sensor.pixel) * aside;
    line.end_pixel += noise(sensor.pixel) * aside;
    line.has_depth = true;
    line.start = start + noise.vector(sensor.line_end);
    line.end = end + noise.vector(sensor.line_end);
    line.start_covariance = line.end_covariance = sensor.line_end * sensor.line_end * Eigen::Matrix3d::Identity();
    line.descriptor = sensor.disturb ? seen_again(world.lines[i].descriptor, sensor.descriptor_flip, random)
                                     : world.lines[i].descriptor;
    if (sensor.identities) line.track_id = static_cast<std::int32_t>(i);
    frame.lines.push_back(line);
    shown.push_back(i);
  }
  return shown;
}

void see_planes(const FeatureWorld& world, const Pose& camera_from_world, const SensorNoise& sensor,
                base::Random& random, FrameFeatures& frame) {
  const Pose world_from_camera = camera_from_world.inverse();
  std::map<std::size_t, std::vector<Eigen::Vector3d>> hits;  // by wall, in the camera frame
  for (int v = kRayStep / 2; v < frame.camera.height; v += kRayStep) {
    for (int u = kRayStep / 2; u < frame.camera.width; u += kRayStep) {
      const Eigen::Vector3d ray = frame.camera.ray({u, v});
      double nearest = kFurthest;
      std::optional<std::size_t> seen;
      for (std::size_t i = 0; i < world.walls.size(); ++i) {
        const geometry::Plane plane = geometry::transform(camera_from_world, world.walls[i].plane());
        const double depth = -plane.distance / plane.normal.dot(ray);
        if (!(depth > kNearest && depth < nearest)) continue;
        const Eigen::Vector3d place = world_from_camera * (depth * ray) - world.walls[i].centre;
        if (std::abs(place.dot(world.walls[i].half_u)) > world.walls[i].half_u.squaredNorm() ||
            std::abs(place.dot(world.walls[i].half_v)) > world.walls[i].half_v.squaredNorm()) {
          continue;
        }
        nearest = depth;
        seen = i;
      }
      if (seen) hits[*seen].push_back(nearest * ray);
    }
  }

  Noise noise(sensor, random);
  for (const auto& [wall, points] : hits) {
    if (static_cast<int>(points.size()) < kMinRays) continue;
    features::PlaneFeature feature;
    for (const Eigen::Vector3d& point : points) feature.centroid += point / static_cast<double>(points.size());
    const geometry::Plane exact = geometry::transform(camera_from_world, world.walls[wall].plane());
    feature.plane.normal = noise.direction(exact.normal, sensor.plane_tilt);
    // Tilt about the centroid and height there are independent.
    feature.plane.distance = -feature.plane.normal.dot(feature.centroid) + noise(sensor.plane_height);
    Eigen::Matrix<double, 4, 3> jacobian = Eigen::Matrix<double, 4, 3>::Zero();
    jacobian.topLeftCorner<3, 2>() = geometry::tangent_basis(feature.plane.normal);
    jacobian.bottomLeftCorner<1, 2>() = -feature.centroid.transpose() * jacobian.topLeftCorner<3, 2>();
    jacobian(3, 2) = 1.0;
    const Eigen::Vector3d sigmas(sensor.plane_tilt, sensor.plane_tilt, sensor.plane_height);
    feature.covariance = jacobian * sigmas.cwiseAbs2().asDiagonal() * jacobian.transpose();
    feature.support = static_cast<std::int32_t>(points.size()) * kRayStep * kRayStep;
    frame.directions.push_back({DirectionKind::plane_normal, feature.plane.normal,
                                tangential_covariance(feature.plane.normal, sensor.plane_tilt), feature.support,
                                static_cast<std::int32_t>(frame.planes.size())});
    frame.planes.push_back(feature);
  }
}

/// Parallel lines of one view make a vanishing direction, a single line a potential one.
void group_lines(const FeatureWorld& world, const std::vector<std::size_t>& shown, const Pose& camera_from_world,
                 const SensorNoise& sensor, base::Random& random, FrameFeatures& frame) {
  Noise noise(sensor, random);
  const auto direction = [&](std::size_t line) {
    return (world.lines[line].end - world.lines[line].start).normalized();
  };
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (frame.lines[i].direction >= 0) continue;
    const auto index = static_cast<std::int32_t>(frame.directions.size());
    std::int32_t support = 0;
    for (std::size_t j = i; j < shown.size(); ++j) {
      if (geometry::axial_angle(direction(shown[i]), direction(shown[j])) > kParallel) continue;
      frame.lines[j].direction = index;
      ++support;
    }
    const double sign = random.index(2) == 0 ? -1.0 : 1.0;
    const Eigen::Vector3d seen =
        noise.direction(sign * (camera_from_world.rotation * direction(shown[i])), sensor.direction);
    const bool single = support == 1;
    frame.directions.push_back({single ? DirectionKind::potential_direction : DirectionKind::vanishing_direction, seen,
                                tangential_covariance(seen, sensor.direction), support,
                                single ? static_cast<std::int32_t>(i) : -1});
  }
}

void add_wall(FeatureWorld& world, const WorldWall& wall, int corners, base::Random& random) {
  world.walls.push_back(wall);
  for (int i = 0; i < corners; ++i) {
    const Eigen::Vector3d place =
        wall.centre + random.uniform(-0.95, 0.95) * wall.half_u + random.uniform(-0.95, 0.95) * wall.half_v;
    world.corners.push_back({place, random_descriptor(random)});
  }
}

/// The twelve edges of the box, and on two walls a board whose sides are slanted.
void add_lines(FeatureWorld& world, const RoomOptions& options, base::Random& random) {
  const Eigen::Vector3d& h = options.half_size;
  const auto add = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    world.lines.push_back({options.orientation * a, options.orientation * b, random_descriptor(random)});
  };
  for (const double p : {-1.0, 1.0}) {
    for (const double q : {-1.0, 1.0}) {
      add({-h.x(), p * h.y(), q * h.z()}, {h.x(), p * h.y(), q * h.z()});
      add({p * h.x(), -h.y(), q * h.z()}, {p * h.x(), h.y(), q * h.z()});
      add({p * h.x(), q * h.y(), -h.z()}, {p * h.x(), q * h.y(), h.z()});
    }
    add({-0.8, -0.6, p * h.z()}, {0.2, 0.7, p * h.z()});
    add({0.0, -0.6, p * h.z()}, {1.0, 0.7, p * h.z()});
  }
}

}  // namespace

FeatureWorld make_room(const RoomOptions& options) {
  base::Random random(options.seed);
  FeatureWorld world;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto along = [&](int a) -> Eigen::Vector3d {
        return options.half_size[a % 3] * options.orientation.col(a % 3);
      };
      add_wall(world, {side * along(axis), along(axis + 1), along(axis + 2), -side * options.orientation.col(axis)},
               options.corners_per_wall, random);
    }
  }
  if (options.lines) add_lines(world, options, random);
  return world;
}

FrameFeatures observe(const FeatureWorld& world, const CameraModel& camera, const Pose& world_from_camera,
                      const image::FrameHeader& header, base::Random& random, const SensorNoise& noise) {
  FrameFeatures frame;
  frame.header = header;
  frame.camera = camera;
  const Pose camera_from_world = world_from_camera.inverse();
  see_points(world, camera_from_world, noise, random, frame);
  const auto shown = see_lines(world, camera_from_world, noise, random, frame);
  see_planes(world, camera_from_world, noise, random, frame);
  group_lines(world, shown, camera_from_world, noise, random, frame);
  return frame;
}

FeatureSequence record(const FeatureWorld& world, const CameraModel& camera, const std::vector<Pose>& world_from_camera,
                       std::uint64_t seed, const SensorNoise& noise) {
  base::Random random(seed);
  FeatureSequence sequence;
  for (std::size_t i = 0; i < world_from_camera.size(); ++i) {
    const auto number = static_cast<std::int64_t>(i);
    sequence.frames.push_back(
        observe(world, camera, world_from_camera[i], {1, number, 1'000'000 + number * 1'000'000 / 30}, random, noise));
    sequence.world_from_camera.push_back(world_from_camera.front().inverse() * world_from_camera[i]);
  }
  return sequence;
}

Pose looking_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target, const CameraModel& camera) {
  const Eigen::Vector3d forward = (target - position).normalized();
  // World y points down, as in a camera that is held level; a negative fy turns the camera's own y upwards.
  const Eigen::Vector3d down = camera.fy > 0 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d(-Eigen::Vector3d::UnitY());
  const Eigen::Vector3d right = down.cross(forward).normalized();
  Pose pose;
  pose.rotation << right, forward.cross(right), forward;
  pose.translation = position;
  return pose;
}

}  // namespace eg::test
