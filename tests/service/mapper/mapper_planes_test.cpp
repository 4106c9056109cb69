#include <gtest/gtest.h>

#include <string>

#include "tests/service/mapper/mapper_harness.hpp"

/// What the mapper does with the planes of keyframes. That a map made with them can be corrected, resumed and loaded
/// again to the last bit is what the other tests show: they have noise and planes, too.
namespace eg::services {
namespace {

MapperOptions without_planes() {
  MapperOptions options = coarse();
  options.plane_regularisation = false;
  return options;
}

std::string mesh_of(const MapperOptions& options) {
  Harness mapper(true, options);
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  return mapper.saved_mesh();
}

TEST(MapperPlanesTest, PlanesChangeTheMeshUnlessTheyAreSwitchedOff) {
  EXPECT_NE(mesh_of(coarse()), mesh_of(without_planes()));
  Harness mapper(true, without_planes());
  mapper.features_come = false;
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  EXPECT_EQ(mapper.acknowledged.size(), 1U) << "it waits for features that it does not use";
  EXPECT_EQ(mapper.saved_mesh(), mesh_of(without_planes()));
}

TEST(MapperPlanesTest, InLockstepAKeyframeWaitsForItsFeaturesAndOtherFramesDoNot) {
  Harness mapper(true, coarse());
  mapper.features_come = false;
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  mapper.send_frame(1);
  mapper.send_pose(1, -1);
  EXPECT_TRUE(mapper.acknowledged.empty());
  mapper.send_features(0, channels::kFeatures);
  ASSERT_EQ(mapper.acknowledged.size(), 1U);
  EXPECT_EQ(mapper.acknowledged.back().sequence, 1);
  EXPECT_EQ(mapper.saved_mesh(), mesh_of(coarse()));
}

TEST(MapperPlanesTest, InRealTimeFeaturesThatDoNotComeAreAskedForByKeyframe) {
  Harness mapper(false, coarse());
  mapper.features_come = false;
  mapper.send_frame(4);
  mapper.send_pose(4, 0);
  for (int i = 0; i < 40; ++i) mapper.send_frame(5 + i);  // its images are kept meanwhile
  EXPECT_EQ(mapper.status().frames, 0);
  mapper.idle(1'000'000);
  ASSERT_EQ(mapper.requests.size(), 1U);
  EXPECT_EQ(mapper.requests.front().channel, channels::kKeyframeFeatures);
  EXPECT_EQ(mapper.requests.front().numbers, std::vector<std::int64_t>{0});
  mapper.send_features(4, channels::kKeyframeFeatures);
  EXPECT_EQ(mapper.status().frames, 1);
  mapper.idle(2'000'000);
  EXPECT_EQ(mapper.requests.size(), 1U) << "it has all it needs";
}

TEST(MapperPlanesTest, FeaturesThatNobodyHasAreReported) {
  Harness mapper(false, coarse());
  mapper.features_come = false;
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  for (int period = 0; period < 30; ++period) mapper.idle(1'000'000 + 300'000 * period);
  EXPECT_EQ(mapper.status().frames, 0);
  EXPECT_EQ(mapper.status().dropped, 1);
}

}  // namespace
}  // namespace eg::services
