#include "common/io/open_structure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/base/random.hpp"
#include "common/features/features.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::io {
namespace {

using testing::HasSubstr;

constexpr std::string_view kPoses = "0 0 0 -2 0 0 0 1\n1 0 0 -1 0 0 0 1\n";
constexpr std::string_view kLandmarks = "4 0.5 0 1\n9 0 0 2\n";
constexpr std::string_view kSequence =
    "Vertex: 0 0 0 -2 0 0 0 1\n"
    "MappointFrameAsso: 4 0 400.5 300 \n"
    "MappointFrameAsso: 9 1 320 240.25\n"
    "MaplineFrameAsso: 3 1 10 20 2.5 30 40 3.5\n"
    "ParalineMaplineAsso: 6 2 3 5 \n"
    "Mappoint: 4 0.4 0 1\n"
    "Mapline: 3 0 0 0 1 1 1\n";

class OpenStructure : public testing::Test {
 protected:
  OpenStructure() {
    folder_.write("ground_truth.txt", kPoses);
    folder_.write("point_landmarks.txt", kLandmarks);
    folder_.write("venom_sequence.txt", kSequence);
  }

  std::string error(const std::string& file, std::string_view text) {
    folder_.write(file, text);
    const auto recording = read_open_structure(folder_.path());
    EXPECT_FALSE(recording.has_value()) << text;
    return recording ? "" : recording.error().message;
  }

  test::TemporaryFolder folder_;
};

TEST_F(OpenStructure, ReadsWhatWasMeasured) {
  const auto recording = read_open_structure(folder_.path());
  ASSERT_TRUE(recording.has_value()) << recording.error().message;
  ASSERT_EQ(recording->frames.size(), 2U);
  const auto& [first, second] = std::tie(recording->frames[0], recording->frames[1]);
  EXPECT_DOUBLE_EQ(second.time_s, 1.0 / 30.0);
  ASSERT_EQ(first.points.size(), 1U);
  EXPECT_EQ(first.points[0].id, 4);
  EXPECT_EQ(first.points[0].pixel, Eigen::Vector2d(400.5, 300));
  EXPECT_DOUBLE_EQ(first.points[0].true_depth, 3.0);
  EXPECT_DOUBLE_EQ(second.points[0].true_depth, 3.0);
  ASSERT_EQ(second.lines.size(), 1U);
  EXPECT_EQ(second.lines[0].id, 3);
  EXPECT_EQ(second.lines[0].end_pixel, Eigen::Vector2d(30, 40));
  EXPECT_DOUBLE_EQ(second.lines[0].end_depth, 3.5);
  EXPECT_THAT(recording->line_groups, testing::ElementsAre(testing::Pair(3, 6), testing::Pair(5, 6)));
}

TEST_F(OpenStructure, SaysWhatIsWrongAndWhere) {
  const std::string file = "venom_sequence.txt";
  EXPECT_THAT(error(file, "MappointFrameAsso: 4 0 400 300\nSomething: 1 2\n"),
              HasSubstr("venom_sequence.txt:2: 'Something:' is no keyword of the format"));
  EXPECT_THAT(error(file, "MappointFrameAsso: 4 0 400\n"),
              HasSubstr(":1: expected 'MappointFrameAsso: point frame u v'"));
  EXPECT_THAT(error(file, "MappointFrameAsso: 4 0 400 nan\n"), HasSubstr(":1: expected 'MappointFrameAsso"));
  EXPECT_THAT(error(file, "MappointFrameAsso: -4 0 400 1\n"), HasSubstr(":1: expected 'MappointFrameAsso"));
  EXPECT_THAT(error(file, "MappointFrameAsso: 4 99999999999 400 1\n"), HasSubstr(":1: expected 'MappointFrameAsso"));
  EXPECT_THAT(error(file, "MappointFrameAsso: 4 2 400 1\n"), HasSubstr(":1: frame 2 has no pose: there are 2"));
  EXPECT_THAT(error(file, "MappointFrameAsso: 5 0 400 1\n"), HasSubstr(":1: point 5 has no position"));
  EXPECT_THAT(error(file, "MappointFrameAsso: 4 0 1 1\nMappointFrameAsso: 4 0 2 2\n"),
              HasSubstr(":2: point 4 is observed twice in frame 0"));
  EXPECT_THAT(error(file, "MaplineFrameAsso: 3 1 10 20 2.5 30 40\n"), HasSubstr(":1: expected 'MaplineFrameAsso"));
  EXPECT_THAT(error(file, "MaplineFrameAsso: 3 7 10 20 2.5 30 40 1\n"), HasSubstr(":1: frame 7 has no pose"));
  EXPECT_THAT(error(file, "MaplineFrameAsso: 3 1 1 2 3 4 5 6\nMaplineFrameAsso: 3 1 1 2 3 4 5 6\n"),
              HasSubstr(":2: line 3 is observed twice in frame 1"));
  EXPECT_THAT(error(file, "ParalineMaplineAsso: 0 3 1 2\n"), HasSubstr(":1: the group has 2 lines, not 3"));
  EXPECT_THAT(error(file, "ParalineMaplineAsso: 0\n"), HasSubstr(":1: expected 'ParalineMaplineAsso"));
  EXPECT_THAT(error(file, "ParalineMaplineAsso: 0 2 1 x\n"), HasSubstr(":1: expected 'ParalineMaplineAsso"));
  EXPECT_THAT(error(file, "ParalineMaplineAsso: 0 1 3\nParalineMaplineAsso: 1 1 3\n"),
              HasSubstr(":2: line 3 is in group 0 already"));
}

TEST_F(OpenStructure, SaysWhatIsWrongWithThePosesAndLandmarks) {
  EXPECT_THAT(error("point_landmarks.txt", "4 0.5 0\n"), HasSubstr("point_landmarks.txt:1: expected 'point x y z'"));
  EXPECT_THAT(error("point_landmarks.txt", "4 0 0 1\n4 0 0 1\n"), HasSubstr(":2: point 4 is there twice"));
  EXPECT_THAT(error("point_landmarks.txt", "4 0 0 -3\n9 0 0 2\n"),
              HasSubstr("venom_sequence.txt:2: point 4 is behind the camera of frame 0"));
  EXPECT_THAT(error("ground_truth.txt", "0 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"),
              HasSubstr("frames are not numbered 0, 1, 2"));
  EXPECT_THAT(error("ground_truth.txt", ""), HasSubstr("holds no pose"));
  EXPECT_THAT(read_open_structure("/no/such/folder").error().message, HasSubstr("No such file"));
}

TEST_F(OpenStructure, RefusesMoreFeaturesThanAMessageCarries) {
  std::string landmarks, sequence;
  for (int i = 0; i <= features::kMaxPoints; ++i) {
    landmarks.append(std::to_string(i)).append(" 0 0 1\n");
    sequence.append("MappointFrameAsso: ").append(std::to_string(i)).append(" 0 1 1\n");
  }
  folder_.write("point_landmarks.txt", landmarks);
  EXPECT_THAT(error("venom_sequence.txt", sequence), HasSubstr("more than 4000 points in frame 0"));
}

/// Bytes changed, removed or repeated: an error or a recording, never anything else.
TEST_F(OpenStructure, SurvivesDamagedFiles) {
  base::Random random(1);
  for (int round = 0; round < 200; ++round) {
    std::string text(kSequence);
    for (int damage = random.index(4); damage >= 0 && !text.empty(); --damage) {
      const auto at = static_cast<std::size_t>(random.index(static_cast<int>(text.size())));
      switch (random.index(3)) {
        case 0:
          text[at] = static_cast<char>(random.index(256));
          break;
        case 1:
          text.erase(at, static_cast<std::size_t>(random.index(20)));
          break;
        default:
          text.insert(at, text.substr(static_cast<std::size_t>(random.index(static_cast<int>(text.size()))), 12));
      }
    }
    folder_.write("venom_sequence.txt", text);
    const auto recording = read_open_structure(folder_.path());
    if (recording) {
      EXPECT_EQ(recording->frames.size(), 2U);
    } else {
      EXPECT_THAT(recording.error().message, HasSubstr("venom_sequence.txt:"));
    }
  }
}

}  // namespace
}  // namespace eg::io
