#include "common/eval/result_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <opencv2/core.hpp>

#include "common/eval/known_sequence.hpp"
#include "common/eval/published.hpp"

namespace eg::eval {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double kFails = std::numeric_limits<double>::quiet_NaN();

const ResultTable kTable{
    "Error, (m)", 3, {"ours", "theirs", "others"}, {{"a, 1", {0.0125, 0.5, std::nullopt}}, {"b", {2.0, 0.25, kFails}}}};

TEST(ResultTable, TextHasAColumnPerSystemAndMarksTheBest) {
  const std::string text = to_text(kTable);
  EXPECT_THAT(text, HasSubstr("Error, (m)\n"));
  EXPECT_THAT(text, HasSubstr("a, 1     0.013*     0.500          - \n"));
  EXPECT_THAT(text, HasSubstr("b        2.000      0.250*         x \n"));
}

TEST(ResultTable, CsvHasALinePerValueThatIsThere) {
  EXPECT_EQ(to_csv(std::span(&kTable, 1)),
            "table,sequence,system,value\n"
            "\"Error, (m)\",\"a, 1\",ours,0.012500\n"
            "\"Error, (m)\",\"a, 1\",theirs,0.500000\n"
            "\"Error, (m)\",b,ours,2.000000\n"
            "\"Error, (m)\",b,theirs,0.250000\n"
            "\"Error, (m)\",b,others,failed\n");
}

TEST(ResultTable, DrawsATallerBarForALargerError) {
  const cv::Mat picture = draw_tables(std::span(&kTable, 1));
  const auto blue_pixels = [&](const cv::Mat& part) {
    cv::Mat mask;
    cv::inRange(part, cv::Scalar(200, 90, 20), cv::Scalar(200, 90, 20), mask);
    return cv::countNonZero(mask);
  };
  const int group = 70 + 10 + 140;  // where the second sequence begins
  const cv::Rect below_legend(0, 60, group, picture.rows - 60);
  const int small = blue_pixels(picture(below_legend));
  const int large = blue_pixels(picture(cv::Rect(group, 60, picture.cols - group, picture.rows - 60)));
  EXPECT_GT(small, 0);
  EXPECT_GT(large, 2 * small);
  EXPECT_FALSE(draw_tables({}).empty());
}

TEST(KnownSequence, IsFoundByTheNamesThatFoldersHave) {
  const auto name = [](const char* path) {
    const KnownSequence* sequence = find_sequence(path, false);
    return std::string(sequence == nullptr ? "" : sequence->name);
  };
  EXPECT_EQ(name("/data/icl_office_kt0"), "office room 0");
  EXPECT_EQ(name("/data/icl/of_kt3/"), "office room 3");
  EXPECT_EQ(name("ICL-NUIM/office_room_traj1_frei_png"), "office room 1");
  EXPECT_EQ(name("/x/office_room/traj2_frei_png"), "office room 2");
  EXPECT_EQ(name("living_room_traj2_frei_png"), "living room 2");
  EXPECT_EQ(name("/x/lr_kt1"), "living room 1");
  EXPECT_EQ(name("/x/icl_living_kt0"), "living room 0");
  EXPECT_EQ(name("/x/rgbd_dataset_freiburg3_structure_notexture_far"), "f3_stru_notex");
  EXPECT_EQ(name("/x/tum_fr3_structure_texture_near"), "f3_stru_tex");
  EXPECT_EQ(name("/x/rgbd_dataset_freiburg3_large_cabinet"), "f3_l_cabinet");
  EXPECT_EQ(name("/x/rgbd_dataset_freiburg3_cabinet"), "f3_cabinet");
  EXPECT_EQ(name("/x/rgbd_dataset_freiburg1_360"), "f1_360");
  EXPECT_EQ(name("/x/rgbd_dataset_freiburg3_long_office_household"), "f3_l_o_house");
}

TEST(KnownSequence, IsNotTakenForACopyOrAnother) {
  for (const char* path :
       {"/data/icl_office_kt0_clip", "living_room_traj2n_frei_png", "/x/rgbd_dataset_freiburg1_room_validation",
        "/x/tum_fr1_large_cabinet", "/home/office/kitchen", "room0", "", "/"}) {
    EXPECT_EQ(find_sequence(path, false), nullptr) << path;
  }
  EXPECT_EQ(find_sequence("open_structure/office0", false), nullptr);
  EXPECT_STREQ(find_sequence("open_structure/office0", true)->name, "office0");
  EXPECT_EQ(find_sequence("/x/of_kt3", true), nullptr);
}

TEST(Published, EveryRowIsOfAKnownSequenceAndComplete) {
  for (const PublishedTable& table : published_tables()) {
    for (const auto& [sequence, values] : table.rows) {
      EXPECT_EQ(values.size(), table.systems.size()) << sequence;
      const auto known = known_sequences();
      EXPECT_TRUE(std::any_of(known.begin(), known.end(), [&](const KnownSequence& k) { return k.name == sequence; }))
          << sequence;
    }
  }
}

TEST(Published, TablesHoldTheSequencesThatWereRun) {
  const auto tables = compare_with_published({{"f1_360", 0.1, 1.0, 2.0}, {"office room 0", 0.006, 0.08, 0.09}});
  ASSERT_EQ(tables.size(), 2U) << "rotation and position";
  EXPECT_THAT(tables[0].columns, testing::SizeIs(10));
  ASSERT_EQ(tables[0].rows.size(), 1U);
  EXPECT_THAT(tables[0].rows[0].values, ElementsAre(0.08, 0.09, 0.11, 0.37, 0.18, 5.12, 29.11, 6.71, 0.40, 0.57));
  ASSERT_EQ(tables[1].rows.size(), 2U);
  EXPECT_EQ(tables[1].rows[1].values[0], 0.006);
  EXPECT_THAT(to_text(tables[1]), Not(HasSubstr("living")));
}

}  // namespace
}  // namespace eg::eval
