#include "tests/unit/messages/random_messages.hpp"

#include <algorithm>
#include <limits>

#include "common/geometry/so3.hpp"

namespace eg::messages {
namespace {

using base::Random;

std::int32_t random_int(Random& random, std::int32_t low, std::int32_t high) {
  return low + random.index(high - low + 1);
}

std::int64_t random_counter(Random& random) { return static_cast<std::int64_t>(random.next() >> 5U); }
std::int64_t random_session(Random& random) { return static_cast<std::int64_t>(random.next()); }

template <typename Id>
Id random_id(Random& random) {
  return Id{random_int(random, 0, 1'000'000)};
}

std::string random_text(Random& random, int maximum) {
  std::string text(static_cast<std::size_t>(random_int(random, 0, maximum)), ' ');
  std::generate(text.begin(), text.end(), [&] { return static_cast<char>(random_int(random, ' ', '~')); });
  return text;
}

template <int N>
Eigen::Matrix<double, N, 1> random_vector(Random& random) {
  return Eigen::Matrix<double, N, 1>::NullaryExpr([&] { return random.normal(); });
}

Eigen::Vector3d random_unit(Random& random) { return random_vector<3>(random).normalized(); }

/// Symmetric to the last bit, positive semi-definite, sometimes singular.
template <int N>
Eigen::Matrix<double, N, N> random_covariance(Random& random) {
  Eigen::Matrix<double, N, N> root = Eigen::Matrix<double, N, N>::NullaryExpr([&] { return random.normal(); });
  if (random.uniform() < 0.3) root.col(0).setZero();
  const Eigen::Matrix<double, N, N> product = root * root.transpose();
  return product.template selfadjointView<Eigen::Upper>();
}

geometry::Pose random_pose(Random& random) {
  return {geometry::so3_exp(random_vector<3>(random)), random_vector<3>(random)};
}

image::FrameHeader random_header(Random& random) {
  return {random_session(random), random_counter(random), random_counter(random)};
}

geometry::CameraModel random_camera(Random& random, bool distorted) {
  geometry::CameraModel camera{
      random_text(random, 64), random_int(random, 1, 40), random_int(random, 1, 40), random.uniform(1, 999),
      -random.uniform(1, 999), random.normal(),           random.normal(),           {},
      random.uniform(1, 9999), random.uniform(1, 99)};
  if (distorted) std::generate(camera.distortion.begin(), camera.distortion.end(), [&] { return random.normal(); });
  return camera;
}

features::Descriptor random_descriptor(Random& random) {
  features::Descriptor descriptor;
  std::generate(descriptor.begin(), descriptor.end(), [&] { return static_cast<std::uint8_t>(random.index(256)); });
  return descriptor;
}

cv::Mat random_image(Random& random, const geometry::CameraModel& camera, int type) {
  cv::Mat image(camera.height, camera.width, type);
  const std::size_t bytes = image.total() * image.elemSize();
  std::generate(image.data, image.data + bytes, [&] { return static_cast<std::uint8_t>(random.index(256)); });
  return image;
}

features::PointFeature random_point(Random& random) {
  return {random_vector<2>(random), random.uniform(0.5, 9.0), random.uniform(0.0, 9.0),  random.uniform(),
          random.normal(),          random_int(random, 0, 7), random_descriptor(random), random_int(random, -1, 9999)};
}

features::LineFeature random_line(Random& random, int directions) {
  return {random_vector<2>(random),     random_vector<2>(random),  random.uniform() < 0.5,
          random_vector<3>(random),     random_vector<3>(random),  random_covariance<3>(random),
          random_covariance<3>(random), random_descriptor(random), random_int(random, -1, directions - 1),
          random_int(random, -1, 9999)};
}

features::PlaneFeature random_plane(Random& random) {
  features::PlaneFeature plane;
  plane.plane = {random_unit(random), random.uniform(0.1, 9.0)};
  plane.covariance = random_covariance<4>(random);
  plane.centroid = random_vector<3>(random);
  plane.support = random_int(random, 0, 307200);
  plane.hull.resize(static_cast<std::size_t>(random_int(random, 0, features::kMaxHullPoints)));
  std::generate(plane.hull.begin(), plane.hull.end(), [&] { return random_vector<3>(random); });
  return plane;
}

features::DirectionFeature random_direction(Random& random, int planes, int lines) {
  using features::DirectionKind;
  features::DirectionFeature direction;
  direction.kind = static_cast<DirectionKind>(random.index(3));
  const bool has_source = direction.kind == DirectionKind::plane_normal ? planes > 0 : lines > 0;
  if (!has_source) direction.kind = DirectionKind::vanishing_direction;
  direction.direction = random_unit(random);
  direction.covariance = random_covariance<3>(random);
  direction.support = random_int(random, 0, 307200);
  if (direction.kind == DirectionKind::plane_normal) direction.source = random.index(planes);
  if (direction.kind == DirectionKind::potential_direction) direction.source = random.index(lines);
  return direction;
}

/// Up to ten items made by `make`.
template <typename Make>
auto random_list(Random& random, const Make& make) {
  std::vector<decltype(make())> list;
  for (int left = random.index(11); left > 0; --left) list.push_back(make());
  return list;
}

egraph::Covisibility random_covisibility(Random& random) {
  return {random_id<egraph::KeyframeId>(random), random_int(random, 0, 999)};
}

egraph::KeyframeNode random_node(Random& random) {
  return {random_id<egraph::KeyframeId>(random), random_counter(random), random_counter(random), random_pose(random),
          random_covariance<6>(random)};
}

egraph::DirectionLandmark random_landmark(Random& random) {
  return {random_id<egraph::LandmarkId>(random),
          static_cast<features::DirectionKind>(random.index(3)),
          random_unit(random),
          random_covariance<3>(random),
          random_int(random, 0, 999),
          random_id<egraph::KeyframeId>(random),
          random_id<egraph::KeyframeId>(random)};
}

egraph::Observation random_observation(Random& random) {
  return {random_id<egraph::KeyframeId>(random), random_id<egraph::LandmarkId>(random), random_unit(random),
          random_covariance<3>(random)};
}

egraph::RelativePose random_relative_pose(Random& random) {
  const int first = random_int(random, 0, 999);
  return {egraph::KeyframeId{first}, egraph::KeyframeId{first + random_int(random, 1, 999)}, random_pose(random),
          random_covariance<6>(random)};
}

egraph::CorrectedPose random_corrected_pose(Random& random) {
  return {random_id<egraph::KeyframeId>(random), random_pose(random)};
}

}  // namespace

template <>
image::RgbdFrame random_value(Random& random) {
  const geometry::CameraModel camera = random_camera(random, true);
  return {random_header(random), camera, random_image(random, camera, CV_8UC3), random_image(random, camera, CV_16UC1)};
}

template <>
features::FrameFeatures random_value(Random& random) {
  const int planes = random.index(5);
  const int lines = random.index(5);
  const int directions = random.index(5);
  features::FrameFeatures frame;
  frame.header = random_header(random);
  frame.camera = random_camera(random, false);
  frame.points = random_list(random, [&] { return random_point(random); });
  for (int i = 0; i < lines; ++i) frame.lines.push_back(random_line(random, directions));
  for (int i = 0; i < planes; ++i) frame.planes.push_back(random_plane(random));
  for (int i = 0; i < directions; ++i) frame.directions.push_back(random_direction(random, planes, lines));
  return frame;
}

template <>
tracking::PoseEstimate random_value(Random& random) {
  tracking::PoseEstimate pose;
  pose.header = random_header(random);
  pose.state = static_cast<tracking::TrackingState>(random.index(5));
  pose.reason = random_text(random, 200);
  pose.has_pose = random.uniform() < 0.5;
  pose.world_from_camera = random_pose(random);
  pose.covariance = random_covariance<6>(random);
  pose.keyframe = egraph::KeyframeId{random_int(random, -1, 9999)};
  pose.rotation_reference = egraph::KeyframeId{random_int(random, -1, 9999)};
  pose.matched_points = random_int(random, 0, 999);
  pose.matched_lines = random_int(random, 0, 999);
  pose.matched_planes = random_int(random, 0, 999);
  pose.matched_directions = random_int(random, 0, 999);
  pose.corrections = random_counter(random);
  return pose;
}

template <>
tracking::PoseCorrection random_value(Random& random) {
  tracking::PoseCorrection correction;
  correction.session = random_session(random);
  correction.since = random_counter(random);
  correction.version = correction.since + random_int(random, 0, 999);
  correction.entries = random_list(random, [&] { return random_corrected_pose(random); });
  return correction;
}

template <>
egraph::Keyframe random_value(Random& random) {
  egraph::Keyframe keyframe;
  keyframe.header = random_header(random);
  keyframe.id = random_id<egraph::KeyframeId>(random);
  keyframe.world_from_camera = random_pose(random);
  keyframe.covariance = random_covariance<6>(random);
  keyframe.directions = random_list(random, [&] { return random_direction(random, 64, 1000); });
  for (const auto& direction : keyframe.directions) {
    const bool plane = direction.kind == features::DirectionKind::plane_normal;
    keyframe.plane_distances.push_back(plane ? random.normal() : std::numeric_limits<double>::quiet_NaN());
  }
  keyframe.covisible = random_list(random, [&] { return random_covisibility(random); });
  keyframe.relative_poses = random_list(random, [&] { return random_relative_pose(random); });
  keyframe.moved = random_list(random, [&] { return random_corrected_pose(random); });
  return keyframe;
}

template <>
egraph::GraphUpdate random_value(Random& random) {
  egraph::GraphUpdate update;
  update.session = random_session(random);
  update.base_version = random_counter(random) / 2;
  update.version = update.base_version + random_int(random, 0, 9);
  update.keyframe = random_node(random);
  update.landmarks = random_list(random, [&] { return random_landmark(random); });
  update.removed = random_list(random, [&] { return random_id<egraph::LandmarkId>(random); });
  update.observations = random_list(random, [&] { return random_observation(random); });
  update.relative_poses = random_list(random, [&] { return random_relative_pose(random); });
  update.moved = random_list(random, [&] { return random_corrected_pose(random); });
  update.corrections = random_list(random, [&] { return random_corrected_pose(random); });
  update.covisible = random_list(random, [&] { return random_covisibility(random); });
  return update;
}

template <>
egraph::GraphSnapshot random_value(Random& random) {
  egraph::GraphSnapshot snapshot;
  snapshot.session = random_session(random);
  snapshot.version = random_counter(random);
  snapshot.keyframes = random_list(random, [&] { return random_node(random); });
  snapshot.landmarks = random_list(random, [&] { return random_landmark(random); });
  snapshot.observations = random_list(random, [&] { return random_observation(random); });
  snapshot.relative_poses = random_list(random, [&] { return random_relative_pose(random); });
  snapshot.parts = random_int(random, 1, 9);
  snapshot.part = random_int(random, 0, snapshot.parts - 1);
  snapshot.next_landmark = random_id<egraph::LandmarkId>(random);
  snapshot.covisibility = random_list(random, [&] {
    return egraph::GraphSnapshot::CovisibilityEdge{random_id<egraph::KeyframeId>(random),
                                                   random_id<egraph::KeyframeId>(random), random_int(random, 0, 999)};
  });
  return snapshot;
}

template <>
mapping::MeshChunk random_value(Random& random) {
  mapping::MeshChunk chunk;
  chunk.session = random_session(random);
  chunk.tile = {random_int(random, -99, 99), random_int(random, -99, 99), random_int(random, -99, 99)};
  chunk.revision = random_int(random, 0, 999);
  chunk.parts = random_int(random, 1, 9);
  chunk.part = random_int(random, 0, chunk.parts - 1);
  chunk.tile_size = random.uniform(0.1, 9.0);
  chunk.mesh.vertices = random_list(random, [&] { return Eigen::Vector3f(random_vector<3>(random).cast<float>()); });
  const int count = static_cast<int>(chunk.mesh.vertices.size());
  for (int i = 0; i < count; ++i) {
    chunk.mesh.normals.emplace_back(random_unit(random).cast<float>());
    chunk.mesh.colours.push_back({static_cast<std::uint8_t>(i), 255, static_cast<std::uint8_t>(random.index(256))});
  }
  const auto corner = [&] { return static_cast<std::uint32_t>(random.index(count)); };
  for (int i = 0; i < 2 * count; ++i) chunk.mesh.triangles.push_back({corner(), corner(), corner()});
  return chunk;
}

template <>
GraphRequest random_value(Random& random) {
  return {random_session(random), random_counter(random)};
}

template <>
MeshRequest random_value(Random& random) {
  return {random_session(random)};
}

template <>
Acknowledge random_value(Random& random) {
  return {random_session(random), random_counter(random), random_text(random, 64)};
}

template <>
EndOfStream random_value(Random& random) {
  return {random_session(random), random_counter(random), random_list(random, [&] { return random_counter(random); })};
}

template <>
ResendRequest random_value(Random& random) {
  return {random_session(random), random_text(random, 64), random_list(random, [&] { return random_counter(random); })};
}

template <>
tracking::KeyframeLinks random_value(Random& random) {
  const auto matches = [&]<typename Match>(Match /*kind*/) {
    return random_list(random, [&] {
      return Match{random_int(random, 0, 999), random_id<decltype(Match::id)>(random)};
    });
  };
  tracking::KeyframeLinks links;
  links.world_from_camera = random_pose(random);
  links.matches.points = matches(tracking::PointMatch{});
  links.matches.lines = matches(tracking::LineMatch{});
  links.matches.planes = matches(tracking::PlaneMatch{});
  links.directions = random_list(random, [&] {
    return egraph::Association{static_cast<std::size_t>(random_int(random, 0, 99)),
                               random_id<egraph::LandmarkId>(random), random.uniform() < 0.5 ? 1.0 : -1.0,
                               random.uniform(0, 9), random.uniform(0, 9)};
  });
  return links;
}

template <>
tracking::LandmarkPositions random_value(Random& random) {
  tracking::LandmarkPositions landmarks;
  landmarks.points = random_list(random, [&] {
    return tracking::LandmarkPositions::Point{random_vector<3>(random), random.uniform() < 0.5};
  });
  landmarks.lines = random_list(random, [&] {
    return tracking::LandmarkPositions::Line{random_vector<3>(random), random_vector<3>(random),
                                             random.uniform() < 0.5};
  });
  landmarks.planes = random_list(random, [&] { return geometry::Plane{random_unit(random), random.uniform(-9, 9)}; });
  return landmarks;
}

template <>
Control random_value(Random& random) {
  return {random_session(random), static_cast<Command>(random.index(2)), random_text(random, 64)};
}

template <>
ControlReply random_value(Random& random) {
  return {random_session(random), random_text(random, 64), random.uniform() < 0.5, random_text(random, 200)};
}

template <>
ServiceStatus random_value(Random& random) {
  return {random_counter(random),   random_text(random, 64),  random_text(random, 64), random_int(random, 0, 9999),
          random_text(random, 64),  random_counter(random),   random_counter(random),  random_counter(random),
          random_text(random, 200), random.uniform(0, 99),    random.uniform(0, 99),   random.uniform(0, 99),
          random.uniform(0, 99),    random.uniform(0, 99999), random_counter(random)};
}

}  // namespace eg::messages
