#include "services/tracker/correction_record.hpp"

#include <gtest/gtest.h>

namespace eg::services {
namespace {

using tracking::PoseCorrection;

PoseCorrection::Entry moved(int keyframe, double x) {
  return {egraph::KeyframeId{keyframe}, {Eigen::Matrix3d::Identity(), {x, 0.0, 0.0}}};
}

TEST(CorrectionRecord, NumbersWhatItAnnounces) {
  CorrectionRecord record;
  EXPECT_TRUE(record.add(3, {}).empty());
  EXPECT_EQ(record.version(), 0);
  const auto first = record.add(3, {moved(0, 1.0), moved(1, 1.0)});
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].session, 3);
  EXPECT_EQ(first[0].since, 0);
  EXPECT_EQ(first[0].version, 1);
  EXPECT_EQ(first[0].entries.size(), 2U);
  const auto second = record.add(3, {moved(1, 2.0)});
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(second[0].since, 1);
  EXPECT_EQ(second[0].version, 2);
}

TEST(CorrectionRecord, WhoMissedSomeGetsWhatIsStillInForce) {
  CorrectionRecord record;
  record.add(3, {moved(0, 1.0), moved(1, 1.0)});
  record.add(3, {moved(1, 2.0)});
  record.add(3, {moved(2, 3.0)});
  const auto all = record.since(0);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].since, 0);
  EXPECT_EQ(all[0].version, 3);
  ASSERT_EQ(all[0].entries.size(), 3U);
  for (const PoseCorrection::Entry& entry : all[0].entries) {
    EXPECT_EQ(entry.world_from_camera.translation.x(), entry.keyframe.value + 1.0);
  }
  const auto newest = record.since(2);
  ASSERT_EQ(newest.size(), 1U);
  EXPECT_EQ(newest[0].entries.size(), 1U);
  EXPECT_TRUE(record.since(3).empty());
  EXPECT_TRUE(record.since(99).empty());
}

TEST(CorrectionRecord, CutsWhatIsTooLargeForAMessage) {
  CorrectionRecord record(2);
  const auto sent = record.add(3, {moved(0, 1.0), moved(1, 1.0), moved(2, 1.0), moved(3, 1.0), moved(4, 1.0)});
  ASSERT_EQ(sent.size(), 3U);
  std::int64_t complete = 0;
  for (const PoseCorrection& part : sent) {
    EXPECT_LE(part.entries.size(), 2U);
    EXPECT_EQ(part.since, complete) << "whoever has one part asks for the next";
    complete = part.version;
  }
  EXPECT_EQ(complete, record.version());
}

}  // namespace
}  // namespace eg::services
