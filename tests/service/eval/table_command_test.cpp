#include "services/eval/table_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "common/io/text_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::service {
namespace {

using testing::HasSubstr;

constexpr std::string_view kPoses = "0.0 0 0 0 0 0 0 1\n0.5 1 0 0 0 0 0 1\n1.0 1 1 0 0 0 0 1\n1.5 0 1 1 0 0 0 1\n";

class TableCommand : public testing::Test {
 protected:
  /// A recording in ICL-NUIM's layout; its images are never opened here.
  void add_recording(const std::string& folder) {
    for (const char* image : {"rgb/0.png", "depth/0.png"}) data_.write(folder + "/" + image, "");
    data_.write(folder + "/groundtruth.txt", kPoses);
  }
  RunPlan plan() { return {.out = out_.path(), .config = {}, .frames = 0, .keep = true}; }

  test::TemporaryFolder data_, out_;
};

TEST_F(TableCommand, FindsTheSequencesInTheOrderOfTheTables) {
  add_recording("a/rgbd_dataset_freiburg3_cabinet");
  add_recording("living_room_traj1_frei_png");
  add_recording("b/c/icl_office_kt0");
  add_recording("icl_office_kt0_clip");
  data_.write("open_structure/corridor1/venom_sequence.txt", "");
  data_.write("empty/tum_fr1_room/readme.txt", "");
  const auto found = find_sequences(data_.path());
  ASSERT_TRUE(found.has_value()) << found.error().message;
  std::vector<std::string> names;
  for (const FoundSequence& sequence : *found) names.emplace_back(sequence.sequence->name);
  EXPECT_THAT(names, testing::ElementsAre("office room 0", "living room 1", "f3_cabinet", "corridor1"));
  EXPECT_EQ(find_sequences(data_.path() / "b/c/icl_office_kt0")->size(), 1U) << "the recording itself is a root too";
}

TEST_F(TableCommand, SaysWhenThereIsNothingToRun) {
  EXPECT_THAT(find_sequences(data_.path()).error().message, HasSubstr("holds no sequence of the paper's tables"));
  EXPECT_THAT(find_sequences("/no/such/folder").error().message, HasSubstr("/no/such/folder: cannot be searched"));
}

TEST_F(TableCommand, WritesTheTablesOfResultsThatAreKept) {
  add_recording("icl_office_kt0");
  add_recording("living_room_traj1_frei_png");
  for (const char* name : {"icl_office_kt0", "living_room_traj1_frei_png"}) {
    out_.write(std::string(name) + "/trajectory.txt", kPoses);
    out_.write(std::string(name) + "/status.json", "{}");
  }
  const auto done = print_table(data_.path(), plan());
  ASSERT_TRUE(done.has_value()) << done.error().message;
  const auto csv = io::read_file(out_.path() / "table.csv");
  ASSERT_TRUE(csv.has_value());
  EXPECT_THAT(*csv, HasSubstr("RMSE (m)\",living room 1,ours,0.000000"));
  EXPECT_THAT(*csv, HasSubstr("RMSE (m)\",living room 1,ORB-SLAM3,0.206000"));
  EXPECT_THAT(*io::read_file(out_.path() / "table.txt"), HasSubstr("office room 0     0.0000*"));
  EXPECT_FALSE(cv::imread((out_.path() / "table.png").string()).empty());
}

TEST_F(TableCommand, WritesTheTablesAndFailsIfASequenceHas) {
  add_recording("icl_office_kt0");
  add_recording("living_room_traj1_frei_png");
  out_.write("icl_office_kt0/trajectory.txt", kPoses);
  for (const char* name : {"icl_office_kt0", "living_room_traj1_frei_png"}) {
    out_.write(std::string(name) + "/status.json", "{}");
  }
  const auto done = print_table(data_.path(), plan());
  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().message, "1 of 2 sequences failed, as said above");
  EXPECT_THAT(*io::read_file(out_.path() / "table.txt"), HasSubstr("office room 0     0.0000*"));
}

TEST_F(TableCommand, AnAblationHasAColumnPerConfiguration) {
  add_recording("icl_office_kt0");
  for (const char* variant : {"all on", "lines_off"}) {
    out_.write(std::string(variant) + "/icl_office_kt0/trajectory.txt", kPoses);
    out_.write(std::string(variant) + "/icl_office_kt0/status.json", "{}");
  }
  EXPECT_THAT(print_ablation(data_.path(), data_.path(), plan()).error().message, HasSubstr("holds no configuration"));
  data_.write("configs/lines_off.yaml", "");
  const auto done = print_ablation(data_.path(), data_.path() / "configs", plan());
  ASSERT_TRUE(done.has_value()) << done.error().message;
  EXPECT_THAT(*io::read_file(out_.path() / "ablation.csv"), HasSubstr("office room 0,lines_off,0.000000"));
}

}  // namespace
}  // namespace eg::service
