#include <gtest/gtest.h>

#include <limits>
#include <opencv2/core.hpp>

#include "tests/unit/messages/random_messages.hpp"

namespace eg::messages {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

template <typename T>
std::string complaint(const T& value) {
  const auto decoded = decode<T>(encode(value));
  return decoded ? "none" : decoded.error().message;
}

/// One of everything, all valid.
features::FrameFeatures some_features() {
  features::FrameFeatures frame;
  frame.camera = *geometry::find_camera("synthetic");
  frame.points.resize(4);
  frame.lines.resize(2);
  for (features::LineFeature& line : frame.lines) line.end_pixel = {9, 0};
  frame.planes.resize(2);
  for (features::PlaneFeature& plane : frame.planes) plane.plane.distance = 1.0;
  frame.directions.resize(3);
  for (features::DirectionFeature& direction : frame.directions) direction.source = 0;
  return frame;
}

egraph::Keyframe some_keyframe() {
  egraph::Keyframe keyframe;
  keyframe.id.value = 0;
  keyframe.directions.resize(2);
  keyframe.plane_distances = {1.0, 1.0};
  return keyframe;
}

mapping::MeshChunk some_chunk() {
  mapping::MeshChunk chunk;
  chunk.tile_size = 1.0;
  chunk.mesh.vertices.resize(3, Eigen::Vector3f::Zero());
  chunk.mesh.normals.resize(3, Eigen::Vector3f::UnitZ());
  chunk.mesh.colours.resize(3);
  chunk.mesh.triangles = {{0, 1, 2}};
  return chunk;
}

TEST(Validation, AcceptsTheValidExamples) {
  EXPECT_EQ(complaint(some_features()), "none");
  EXPECT_EQ(complaint(some_keyframe()), "none");
  EXPECT_EQ(complaint(some_chunk()), "none");
}

TEST(Validation, NamesTheFieldThatIsNotFinite) {
  auto frame = some_features();
  frame.points[3].depth = kNaN;
  EXPECT_EQ(complaint(frame), "field 'points[3].depth' is not finite");
}

TEST(Validation, NamesNestedFields) {
  egraph::GraphUpdate update;
  update.keyframe.id.value = 0;
  update.keyframe.world_from_camera.rotation *= 1.001;
  EXPECT_EQ(complaint(update), "field 'keyframe.world_from_camera.rotation' is no rotation");
}

TEST(Validation, RefusesReflections) {
  tracking::PoseEstimate pose;
  pose.world_from_camera.rotation *= -1;
  EXPECT_EQ(complaint(pose), "field 'world_from_camera.rotation' is no rotation");
}

TEST(Validation, AcceptsRotationsWithRoundingErrors) {
  tracking::PoseEstimate pose;
  pose.world_from_camera.rotation(0, 1) = 1e-7;
  EXPECT_EQ(complaint(pose), "none");
}

TEST(Validation, RefusesNegativeSigmas) {
  auto frame = some_features();
  frame.points[0].depth_sigma = -1e-9;
  EXPECT_EQ(complaint(frame), "field 'points[0].depth_sigma' is negative");
  frame = some_features();
  frame.points[1].pixel_sigma = 0;
  EXPECT_EQ(complaint(frame), "field 'points[1].pixel_sigma' is not positive");
}

TEST(Validation, RefusesWhatWouldDivideByZero) {
  auto frame = some_features();
  frame.points[2].depth = 1.0;
  frame.points[2].depth_sigma = 0.0;
  EXPECT_EQ(complaint(frame), "field 'points[2].depth_sigma' is zero beside a depth");

  frame = some_features();
  frame.lines[1].end_pixel = frame.lines[1].start_pixel;
  EXPECT_EQ(complaint(frame), "field 'lines[1].end_pixel' is the start of the line, too");

  frame = some_features();
  frame.lines[0].has_depth = true;
  frame.lines[0].start = frame.lines[0].end = {1, 2, 3};
  EXPECT_EQ(complaint(frame), "field 'lines[0].end' is the start of the line, too");
}

TEST(Validation, RefusesPlacesOutsideAnyBuilding) {
  auto frame = some_features();
  frame.points[1].depth = 1e300;
  frame.points[1].depth_sigma = 1.0;
  EXPECT_EQ(complaint(frame), "field 'points[1].depth' is farther than 10 km");

  frame = some_features();
  frame.points[0].pixel = {0, -1e9};
  EXPECT_EQ(complaint(frame), "field 'points[0].pixel' is far outside any image");

  auto keyframe = some_keyframe();
  keyframe.world_from_camera.translation.z() = 1e12;
  EXPECT_EQ(complaint(keyframe), "field 'world_from_camera.translation' is farther than 10 km");
}

TEST(Validation, RefusesDirectionsThatAreNoUnitVectors) {
  auto frame = some_features();
  frame.directions[1].direction *= 1.00001;
  EXPECT_EQ(complaint(frame), "field 'directions[1].direction' is no unit vector");
}

TEST(Validation, RefusesImpossibleCovariances) {
  auto frame = some_features();
  frame.directions[0].covariance = Eigen::Vector3d(1, -0.1, 1).asDiagonal();
  EXPECT_EQ(complaint(frame), "field 'directions[0].covariance' has a negative variance");
  frame.directions[0].covariance.setConstant(2.0);
  frame.directions[0].covariance.diagonal().setConstant(1.0);
  EXPECT_EQ(complaint(frame), "field 'directions[0].covariance' is no covariance matrix");
  frame.directions[0].covariance.setConstant(1.0);  // singular, but possible
  EXPECT_EQ(complaint(frame), "none");
}

TEST(Validation, RefusesIndicesOutOfRange) {
  auto frame = some_features();
  frame.lines[1].direction = 3;
  EXPECT_EQ(complaint(frame), "field 'lines[1].direction' is 3, not in [-1, 2]");
  frame = some_features();
  frame.directions[2].source = 2;
  EXPECT_EQ(complaint(frame), "field 'directions[2].source' is 2, not in [0, 1]");
  frame.directions[2].kind = features::DirectionKind::vanishing_direction;
  EXPECT_EQ(complaint(frame), "field 'directions[2].source' is 2, not in [-1, -1]");
}

TEST(Validation, RefusesNormalsWithoutAPlaneAndSingleLinesWithoutALine) {
  auto frame = some_features();
  frame.directions[1].source = -1;
  EXPECT_EQ(complaint(frame), "field 'directions[1].source' is -1, not in [0, 1]");
  frame.directions[1].kind = features::DirectionKind::potential_direction;
  EXPECT_EQ(complaint(frame), "field 'directions[1].source' is -1, not in [0, 1]");
  frame.directions[1].kind = features::DirectionKind::vanishing_direction;
  EXPECT_EQ(complaint(frame), "none");
}

TEST(Validation, RefusesUnknownEnumValues) {
  tracking::PoseEstimate pose;
  pose.state = static_cast<tracking::TrackingState>(5);
  EXPECT_EQ(complaint(pose), "field 'state' is 5, not in [0, 4]");
  Control control;
  control.command = static_cast<Command>(200);
  EXPECT_EQ(complaint(control), "field 'command' is -56, not in [0, 1]");
}

TEST(Validation, RefusesMoreThanTheBounds) {
  auto frame = some_features();
  frame.points.resize(features::kMaxPoints + 1);
  EXPECT_EQ(complaint(frame), "field 'num_points' is 4001, not in [0, 4000]");
  frame = some_features();
  frame.planes[1].hull.resize(features::kMaxHullPoints + 1, Eigen::Vector3d::Zero());
  EXPECT_EQ(complaint(frame), "field 'planes[1].hull_size' is 33, not in [0, 32]");
}

TEST(Validation, RefusesDistortedFeatures) {
  auto frame = some_features();
  frame.camera.distortion[2] = 0.1;
  EXPECT_EQ(complaint(frame), "field 'camera.distortion' is not zero");
}

TEST(Validation, RefusesCamerasThatCannotBe) {
  auto frame = some_features();
  frame.camera.fx = 0;
  EXPECT_EQ(complaint(frame), "field 'camera' is wrong: camera fx must be positive");
  frame.camera.fx = 1;
  frame.camera.width = frame.camera.height = 8192;
  EXPECT_EQ(complaint(frame), "field 'camera' has too many pixels");
}

TEST(Validation, PlaneDistancesMayBeNaNOnlyWhereThereIsNoPlane) {
  auto keyframe = some_keyframe();
  keyframe.directions[1].kind = features::DirectionKind::potential_direction;
  keyframe.plane_distances[1] = kNaN;
  EXPECT_EQ(complaint(keyframe), "none");
  keyframe.plane_distances[1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(complaint(keyframe), "field 'plane_distances[1]' is not finite");
  keyframe.plane_distances = {kNaN, 1.0};
  EXPECT_EQ(complaint(keyframe), "field 'plane_distances[0]' is not finite");
}

TEST(Validation, RefusesIdentitiesAfterWhichThereIsNone) {
  egraph::GraphUpdate update;
  update.keyframe.id.value = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(complaint(update), "field 'keyframe.id' is 2147483647, not in [0, 1073741824]");
  tracking::PoseEstimate pose;
  pose.keyframe.value = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(complaint(pose), "field 'keyframe' is 2147483647, not in [-1, 1073741824]");
}

TEST(Validation, RefusesARelativePoseBetweenAKeyframeAndItself) {
  egraph::GraphSnapshot snapshot;
  snapshot.relative_poses.push_back({egraph::KeyframeId{7}, egraph::KeyframeId{7}, {}});
  EXPECT_EQ(complaint(snapshot), "field 'relative_poses[0].second' is the same keyframe as the first");
}

TEST(Validation, RefusesASnapshotPartThatIsNone) {
  egraph::GraphSnapshot snapshot;
  snapshot.part = 3;
  snapshot.parts = 3;
  EXPECT_EQ(complaint(snapshot), "field 'part' is 3, not in [0, 2]");
  snapshot.parts = 0;
  EXPECT_EQ(complaint(snapshot), "field 'parts' is 0, not in [1, 100000]");
  snapshot.parts = std::numeric_limits<std::int32_t>::min();  // found by the fuzzer: one less is no number
  EXPECT_EQ(complaint(snapshot), "field 'parts' is -2147483648, not in [1, 100000]");
}

TEST(Validation, RefusesMeshVerticesNormalsAndParts) {
  auto chunk = some_chunk();
  chunk.mesh.normals[2].setZero();
  EXPECT_EQ(complaint(chunk), "field 'vertices[2].normal' is no unit vector");
  chunk = some_chunk();
  chunk.mesh.vertices[1].x() = 1e30F;
  EXPECT_EQ(complaint(chunk), "field 'vertices[1].position' is farther than 10 km");
  chunk = some_chunk();
  chunk.part = 1;
  EXPECT_EQ(complaint(chunk), "field 'part' is 1, not in [0, 0]");
}

TEST(Validation, RefusesTrianglesOfVerticesThatAreNotThere) {
  Bytes bytes = encode(some_chunk());
  bytes.back() = 3;  // the last corner of the last triangle
  const auto decoded = decode<mapping::MeshChunk>(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().message, "field 'triangles[0].vertices[2]' is 3, not in [0, 2]");
}

TEST(Validation, AcceptsTheLargestMeshChunk) {
  auto chunk = some_chunk();
  chunk.mesh.vertices.resize(65535, Eigen::Vector3f::Ones());
  chunk.mesh.normals.resize(65535, Eigen::Vector3f::UnitX());
  chunk.mesh.colours.resize(65535);
  chunk.mesh.triangles = {{0, 32768, 65534}};
  const auto decoded = decode<mapping::MeshChunk>(encode(chunk));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->mesh.triangles, chunk.mesh.triangles);
}

TEST(Validation, ShortensTextsAndKeepsThemPrintable) {
  ControlReply reply;
  reply.service = std::string(63, 's') + "ü";  // two bytes: the second would be the 65th
  reply.message = std::string("line\nescape\x1b[2J") + '\0' + "tab\t\u009b2Jend";
  const auto decoded = decode<ControlReply>(encode(reply));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->service, std::string(63, 's'));
  EXPECT_EQ(decoded->message, "line escape [2J tab  2Jend");
}

TEST(Validation, RefusesControlCharactersInTexts) {
  Bytes bytes = encode(Acknowledge{1, 2, "tracker"});
  bytes[bytes.size() - 3] = 0x1b;
  const auto decoded = decode<Acknowledge>(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().message, "field 'consumer' is no printable text");
}

class RgbdValidation : public testing::Test {
 protected:
  RgbdValidation() {
    frame_.camera = *geometry::find_camera("synthetic");
    frame_.camera.width = 32;
    frame_.camera.height = 24;
    frame_.colour = cv::Mat(24, 32, CV_8UC3, cv::Scalar(10, 20, 30));
    frame_.depth = cv::Mat(24, 32, CV_16UC1, cv::Scalar(5000));
  }

  image::RgbdFrame frame_;
};

TEST_F(RgbdValidation, JpegKeepsFlatColourNearly) {
  const auto decoded = decode<image::RgbdFrame>(encode(frame_));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_LE(cv::norm(decoded->colour, frame_.colour, cv::NORM_INF), 3.0);
  EXPECT_EQ(cv::norm(decoded->depth, frame_.depth, cv::NORM_INF), 0.0);
}

TEST_F(RgbdValidation, RefusesImagesOfAnotherSizeThanTheCameras) {
  Bytes bytes = encode(frame_);
  // Fingerprint 8, counts 2 x 4, header 3 x 8: then the camera's width.
  const std::size_t width_at = 8 + 8 + 24;
  ASSERT_EQ(bytes[width_at + 3], 32);
  bytes[width_at + 3] = 33;
  const auto decoded = decode<image::RgbdFrame>(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().message, "field 'colour_data' is wrong: the colour image has 32 x 24 pixels, not 33 x 24");
}

}  // namespace
}  // namespace eg::messages
