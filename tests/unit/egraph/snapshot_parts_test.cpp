#include "common/egraph/snapshot_parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/random.hpp"

namespace eg::egraph {
namespace {

GraphSnapshot large_snapshot(std::int64_t version = 9) {
  GraphSnapshot snapshot;
  snapshot.session = 4;
  snapshot.version = version;
  snapshot.next_landmark = LandmarkId{200};
  KeyframeNode keyframe;
  DirectionLandmark landmark;
  Observation observation;
  RelativePose relative;
  for (int i = 0; i < 100; ++i) {
    keyframe.id = landmark.first_seen = observation.keyframe = relative.first = KeyframeId{i};
    landmark.id = LandmarkId{i};
    relative.second = KeyframeId{i + 1};
    snapshot.keyframes.push_back(keyframe);
    snapshot.landmarks.push_back(landmark);
    for (int j = 0; j < 5; ++j) {
      observation.landmark = LandmarkId{j};
      snapshot.observations.push_back(observation);
    }
    snapshot.covisibility.push_back({KeyframeId{i}, KeyframeId{i + 1}, i});
    snapshot.relative_poses.push_back(relative);
  }
  return snapshot;
}

void expect_whole(const GraphSnapshot& snapshot) {
  EXPECT_EQ(snapshot.session, 4);
  EXPECT_EQ(snapshot.parts, 1);
  EXPECT_EQ(snapshot.next_landmark, LandmarkId{200});
  EXPECT_EQ(snapshot.observations.size(), 500U);
  EXPECT_EQ(snapshot.relative_poses.size(), 100U);
  ASSERT_EQ(snapshot.keyframes.size(), 100U);
  ASSERT_EQ(snapshot.covisibility.size(), 100U);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(snapshot.keyframes[static_cast<std::size_t>(i)].id, KeyframeId{i});
    EXPECT_EQ(snapshot.covisibility[static_cast<std::size_t>(i)].shared_features, i);
  }
}

TEST(SnapshotParts, OfAnEmptyGraphAreOne) {
  const auto parts = split(GraphSnapshot{});
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_TRUE(SnapshotAssembler().add(parts.front()).has_value());
}

TEST(SnapshotParts, ComeTogetherInAnyOrderAndNumber) {
  base::Random random(1);
  for (const std::size_t bytes : {1U, 1000U, 5000U, 1000000U}) {
    auto parts = split(large_snapshot(), bytes);
    for (std::size_t i = 1; i < parts.size(); ++i) {
      std::swap(parts[i], parts[static_cast<std::size_t>(random.index(static_cast<int>(i) + 1))]);
    }
    SnapshotAssembler assembler;
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
      EXPECT_FALSE(assembler.add(parts[i]).has_value());
      EXPECT_FALSE(assembler.add(parts[i]).has_value()) << "twice";
    }
    const auto whole = assembler.add(parts.back());
    ASSERT_TRUE(whole.has_value());
    expect_whole(*whole);
  }
}

TEST(SnapshotParts, OfANewerVersionDisplaceOlderOnes) {
  const auto older = split(large_snapshot(9), 20'000);
  const auto newer = split(large_snapshot(10), 20'000);
  ASSERT_GT(older.size(), 2U);
  SnapshotAssembler assembler;
  for (std::size_t i = 0; i + 1 < older.size(); ++i) EXPECT_FALSE(assembler.add(older[i]).has_value());
  EXPECT_FALSE(assembler.add(newer.front()).has_value());
  EXPECT_FALSE(assembler.add(older.back()).has_value()) << "too late";
  for (std::size_t i = 1; i + 1 < newer.size(); ++i) EXPECT_FALSE(assembler.add(newer[i]).has_value());
  const auto whole = assembler.add(newer.back());
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->version, 10);
}

}  // namespace
}  // namespace eg::egraph
