#include "common/synthetic/structure.hpp"

#include <gtest/gtest.h>

#include "common/synthetic/sequence.hpp"

namespace eg::synthetic {
namespace {

SyntheticSequence sequence_of(const std::string& scene) {
  SequenceOptions options;
  options.scene = scene;
  return *SyntheticSequence::make(options);
}

TEST(Structure, CornerHasThreePlanesAndThreeDirections) {
  const SceneStructure structure = structure_of(*make_scene("corner", 1));
  EXPECT_EQ(structure.planes.size(), 3U);
  EXPECT_EQ(structure.directions.size(), 3U);
  EXPECT_EQ(structure.edges.size(), 9U) << "three squares that share three edges";
}

TEST(Structure, SlantedHasManyDirectionsAndTheirEdgesArePerpendicularToTheirPlanesNormals) {
  const Scene scene = *make_scene("slanted", 1);
  const SceneStructure structure = structure_of(scene);
  EXPECT_GT(structure.directions.size(), 15U);
  for (const TrueEdge& edge : structure.edges) {
    const Eigen::Vector3d& direction = structure.directions[static_cast<std::size_t>(edge.direction)];
    EXPECT_NEAR(std::abs(direction.dot((edge.end - edge.start).normalized())), 1.0, 1e-7);
  }
  std::size_t surfaces = 0;
  for (const TruePlane& plane : structure.planes) {
    surfaces += plane.surfaces.size();
    for (const int index : plane.surfaces) {
      const Surface& surface = scene.surfaces[static_cast<std::size_t>(index)];
      EXPECT_NEAR(plane.plane.signed_distance(surface.origin), 0.0, 1e-3);
    }
  }
  EXPECT_EQ(surfaces, scene.surfaces.size());
}

TEST(Structure, EdgesOfTheCornerAreSeenWhereTheCameraLooks) {
  const SyntheticSequence sequence = sequence_of("corner");
  const SceneStructure structure = structure_of(sequence.scene());
  const auto lengths =
      visible_lengths(structure, sequence.render(0), sequence.options().camera, sequence.world_from_camera(0));
  int seen = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const TrueEdge& edge = structure.edges[i];
    const Eigen::Vector3d corner(1.8, 1.8, 0.0);
    const bool at_corner = (edge.start - corner).norm() < 1e-9 || (edge.end - corner).norm() < 1e-9;
    if (at_corner) {
      EXPECT_GT(lengths[i], 100.0);
    }
    seen += lengths[i] > 0 ? 1 : 0;
  }
  EXPECT_EQ(seen, 3);
}

TEST(Structure, HiddenEdgesAreNotSeen) {
  // Bottom edges of the bookshelf's books lie behind its boards' fronts or in view; the room's far corner behind the
  // camera never is: the sum of what is seen from two opposite headings cannot hold one edge twice in full.
  const SyntheticSequence sequence = sequence_of("room");
  const SceneStructure structure = structure_of(sequence.scene());
  const geometry::CameraModel& camera = sequence.options().camera;
  const auto first = visible_lengths(structure, sequence.render(0), camera, sequence.world_from_camera(0));
  const auto opposite = visible_lengths(structure, sequence.render(540), camera, sequence.world_from_camera(540));
  int in_both = 0;
  int in_first = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    in_first += first[i] > 20 ? 1 : 0;
    in_both += first[i] > 20 && opposite[i] > 20 ? 1 : 0;
  }
  EXPECT_GT(in_first, 20);
  EXPECT_EQ(in_both, 0);
}

TEST(Sequence, FramesCarryTimeCameraAndSensorDepth) {
  SequenceOptions options;
  options.scene = "corner";
  options.session = 9;
  options.frame_count = 40;
  const SyntheticSequence sequence = *SyntheticSequence::make(options);
  EXPECT_EQ(sequence.size(), 40);
  const image::RgbdFrame frame = sequence.frame(31);
  EXPECT_EQ(frame.header.session, 9);
  EXPECT_EQ(frame.header.sequence, 31);
  EXPECT_EQ(frame.header.utime, 1'000'000 + 1'033'333);
  EXPECT_EQ(frame.camera, options.camera);
  EXPECT_EQ(frame.colour.type(), CV_8UC3);
  EXPECT_EQ(frame.depth.type(), CV_16UC1);
  EXPECT_NEAR(frame.depth.at<std::uint16_t>(200, 300), 5000.0 * sequence.render(31).depth.at<float>(200, 300), 0.51);
  EXPECT_DOUBLE_EQ(sequence.ground_truth(31).time_s, 1e-6 * static_cast<double>(frame.header.utime));
}

TEST(Sequence, RejectsBadOptions) {
  SequenceOptions options;
  options.frame_count = -1;
  EXPECT_FALSE(SyntheticSequence::make(options).has_value());
  options = {};
  options.camera.fx = 0;
  EXPECT_FALSE(SyntheticSequence::make(options).has_value());
  options = {};
  options.trajectory = "nowhere";
  EXPECT_FALSE(SyntheticSequence::make(options).has_value());
  options = {};
  options.noise = NoiseOptions{};
  options.noise->depth.baseline = -1;
  EXPECT_FALSE(SyntheticSequence::make(options).has_value());
}

}  // namespace
}  // namespace eg::synthetic
