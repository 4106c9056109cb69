#include "common/io/dataset.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace eg::io {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

std::vector<std::string> colour_names(const Dataset& dataset) {
  std::vector<std::string> names;
  for (const auto& frame : dataset.frames) names.push_back(frame.colour_path.filename());
  return names;
}

std::vector<std::string> depth_names(const Dataset& dataset) {
  std::vector<std::string> names;
  for (const auto& frame : dataset.frames) names.push_back(frame.depth_path.filename());
  return names;
}

class DatasetTest : public testing::Test {
 protected:
  void write_lists(std::string_view rgb, std::string_view depth) {
    folder_.write("rgb.txt", rgb);
    folder_.write("depth.txt", depth);
  }
  std::string error_of_open() {
    const auto dataset = open_dataset(folder_.path());
    EXPECT_FALSE(dataset.has_value());
    if (dataset) return {};
    EXPECT_THAT(dataset.error().message, HasSubstr(folder_.path().string()));
    EXPECT_EQ(dataset.error().message.find('\n'), std::string::npos);
    return dataset.error().message;
  }
  test::TemporaryFolder folder_;
};

TEST_F(DatasetTest, AssociatesListsByTimeAndCountsWhatIsLeft) {
  write_lists("# colour images\n# timestamp filename\n\n1.000 rgb/a.png\n1.033 rgb/b.png\r\n1.066 rgb/c.png\n",
              "1.005 depth/a.png\n1.090 depth/b.png\n1.070 depth/c.png\n");
  EXPECT_THAT(error_of_open(), HasSubstr("depth.txt:3: time stamp 1.070 is earlier than that of line 2"));

  write_lists("1.000 rgb/a.png\n1.033 rgb/b.png\n1.066 rgb/c.png\n",
              "1.005\tdepth/a.png\n1.070,depth/c.png\n9 depth/d.png\n");
  const auto dataset = open_dataset(folder_.path());
  ASSERT_TRUE(dataset.has_value()) << dataset.error().message;
  EXPECT_EQ(dataset->layout, DatasetLayout::lists);
  EXPECT_THAT(colour_names(*dataset), ElementsAre("a.png", "c.png"));
  EXPECT_THAT(depth_names(*dataset), ElementsAre("a.png", "c.png"));
  EXPECT_EQ(dataset->frames[1].utime, 1066000);
  EXPECT_DOUBLE_EQ(dataset->frames[1].time_s, 1.066);
  EXPECT_EQ(dataset->frames[0].colour_path, folder_.path() / "rgb/a.png");
  EXPECT_EQ(dataset->unpaired_colour, 1);
  EXPECT_EQ(dataset->unpaired_depth, 1);
  EXPECT_TRUE(dataset->ground_truth.empty());
}

TEST_F(DatasetTest, KeepsMicrosecondsOfEpochTimes) {
  write_lists("1341836537.655662 a.png\n", "1341836537.655691 d.png\n");
  const auto dataset = open_dataset(folder_.path());
  ASSERT_TRUE(dataset.has_value());
  EXPECT_EQ(dataset->frames[0].utime, 1341836537655662);
}

TEST_F(DatasetTest, TheToleranceIsInclusiveAndExact) {
  write_lists("1341836537.000000 a.png\n1341836538.0 b.png\n", "1341836537.020000 d.png\n1341836538.020001 e.png\n");
  const auto dataset = open_dataset(folder_.path());
  ASSERT_TRUE(dataset.has_value());
  EXPECT_THAT(depth_names(*dataset), ElementsAre("d.png"));
}

TEST_F(DatasetTest, ReadsAssociationsInEitherOrder) {
  folder_.write("associations.txt", "1.5 rgb/a.png 1.51 depth/a.png\n1.6 rgb/b.png 1.61 depth/b.png\n");
  auto dataset = open_dataset(folder_.path());
  ASSERT_TRUE(dataset.has_value()) << dataset.error().message;
  EXPECT_EQ(dataset->layout, DatasetLayout::associations);
  EXPECT_EQ(dataset->frames[0].utime, 1500000);
  EXPECT_EQ(dataset->frames[0].depth_path, folder_.path() / "depth/a.png");

  folder_.write("associations.txt", "1.51 Depth/a.png 1.5 rgb/a.png\n");
  dataset = open_dataset(folder_.path());
  ASSERT_TRUE(dataset.has_value()) << dataset.error().message;
  EXPECT_EQ(dataset->frames[0].utime, 1500000);
  EXPECT_EQ(dataset->frames[0].colour_path, folder_.path() / "rgb/a.png");
}

TEST_F(DatasetTest, IntegersInAssociationsAreImageNumbers) {
  folder_.write("associations.txt", "0 depth/0.png 0 rgb/0.png\n3 depth/3.png 3 rgb/3.png\n");
  const auto dataset = open_dataset(folder_.path());
  ASSERT_TRUE(dataset.has_value()) << dataset.error().message;
  EXPECT_EQ(dataset->frames[0].utime, 0);
  EXPECT_EQ(dataset->frames[1].utime, 100000);
}

TEST_F(DatasetTest, OneDecimalPointMakesAllOfThemSeconds) {
  folder_.write("associations.txt", "1 depth/0.png 1 rgb/0.png\n2.5 depth/3.png 2.5 rgb/3.png\n");
  const auto dataset = open_dataset(folder_.path());
  ASSERT_TRUE(dataset.has_value());
  EXPECT_EQ(dataset->frames[0].utime, 1000000);
}

TEST_F(DatasetTest, ReadsNumberedImagesInNumericOrder) {
  for (const char* name : {"rgb/0.png", "rgb/2.jpg", "rgb/10.png", "rgb/11.png", "rgb/notes.txt", "depth/2.png",
                           "depth/10.png", "depth/0.png", "depth/thumb.png"}) {
    folder_.write(name, "");
  }
  folder_.write("livingRoom2.gt.freiburg", "");
  const auto dataset = open_dataset(folder_.path());
  ASSERT_TRUE(dataset.has_value()) << dataset.error().message;
  EXPECT_EQ(dataset->layout, DatasetLayout::numbered);
  EXPECT_THAT(colour_names(*dataset), ElementsAre("0.png", "2.jpg", "10.png"));
  EXPECT_EQ(dataset->frames[1].utime, 66667);
  EXPECT_EQ(dataset->unpaired_colour, 1);
  EXPECT_THAT(dataset->ground_truth.string(), EndsWith("livingRoom2.gt.freiburg"));
}

TEST_F(DatasetTest, PrefersGroundtruthTxt) {
  write_lists("1.0 a.png\n", "1.0 d.png\n");
  folder_.write("a.gt.freiburg", "");
  folder_.write("groundtruth.txt", "");
  EXPECT_THAT(open_dataset(folder_.path())->ground_truth.string(), EndsWith("/groundtruth.txt"));
}

TEST_F(DatasetTest, SaysWhatIsWrong) {
  EXPECT_THAT(error_of_open(), HasSubstr("is no data set"));
  folder_.write("rgb.txt", "1.0 rgb/a.png\n");
  EXPECT_THAT(error_of_open(), HasSubstr("depth.txt: no such file, though rgb.txt is there"));
  folder_.write("depth.txt", "# nothing\n\n");
  EXPECT_THAT(error_of_open(), HasSubstr("depth.txt: names no images"));
  write_lists("", "1.0 depth/a.png\n");
  EXPECT_THAT(error_of_open(), HasSubstr("rgb.txt: names no images"));
  write_lists("# x\n1.0 rgb/a.png\n1.1\n", "1.0 depth/a.png\n");
  EXPECT_THAT(error_of_open(), HasSubstr("rgb.txt:3: expected 'timestamp filename', found '1.1'"));
  write_lists("1,0 rgb/a.png\n", "1.0 depth/a.png\n");
  EXPECT_THAT(error_of_open(), HasSubstr("rgb.txt:1: expected 'timestamp filename'"));
  for (const char* stamp : {"now", "nan", "inf", "-1.0", "1e300", "1.0s", "0x10"}) {
    write_lists(std::string(stamp) + " rgb/a.png\n", "1.0 depth/a.png\n");
    EXPECT_THAT(error_of_open(), HasSubstr("rgb.txt:1: '" + std::string(stamp) + "' is not a time stamp in seconds"));
  }
  write_lists("1.0 rgb/a.png\n1.0 rgb/b.png\n", "1.0 depth/a.png\n");
  EXPECT_THAT(error_of_open(), HasSubstr("rgb.txt:2: time stamp 1.0 repeats that of line 1"));
  write_lists("1.5 rgb/a.png\n1.0 rgb/b.png\n", "1.0 depth/a.png\n");
  EXPECT_THAT(error_of_open(), HasSubstr("rgb.txt:2: time stamp 1.0 is earlier than that of line 1"));
  write_lists("1.0 rgb/a.png\n", "1.5 depth/a.png\n");
  EXPECT_THAT(error_of_open(), HasSubstr("no image of rgb.txt is within 20 ms of one of depth.txt"));
}

TEST_F(DatasetTest, RefusesPathsThatLeaveTheFolder) {
  for (const char* path : {"../secret.png", "rgb/../../secret.png", "/etc/passwd"}) {
    write_lists("1.0 " + std::string(path) + "\n", "1.0 depth/a.png\n");
    EXPECT_THAT(error_of_open(), HasSubstr("rgb.txt:1: image path '" + std::string(path) + "' leaves the data set's"));
  }
}

TEST_F(DatasetTest, SaysWhatIsWrongWithAssociations) {
  folder_.write("associate.txt", "1.0 rgb/a.png 1.0\n");
  EXPECT_THAT(error_of_open(), HasSubstr("associate.txt:1: expected 'timestamp filename timestamp filename'"));
  folder_.write("associate.txt", "1.0 rgb/a.png 1.0 d/a.png\n");
  EXPECT_THAT(error_of_open(), HasSubstr("associate.txt:1: exactly one of the two file names must contain 'depth'"));
  folder_.write("associate.txt", "1.0 rgb/a.png 1.0 depth/a.png\n1.0 rgb/b.png 1.1 depth/b.png\n");
  EXPECT_THAT(error_of_open(), HasSubstr("associate.txt:2: time stamp 1.0 repeats"));
}

TEST_F(DatasetTest, SaysWhatIsWrongWithNumberedImages) {
  folder_.write("rgb/1.png", "");
  folder_.write("depth/2.png", "");
  EXPECT_THAT(error_of_open(), HasSubstr("no numbered image is in both"));
  folder_.write("rgb/01.jpg", "");
  EXPECT_THAT(error_of_open(), HasSubstr("two images with the number 1"));
}

TEST(Dataset, MissingFolderAndFileInsteadOfFolder) {
  EXPECT_EQ(open_dataset("/no/such/folder").error().message, "/no/such/folder: no such folder");
  test::TemporaryFolder folder;
  const auto file = folder.write("file", "");
  EXPECT_EQ(open_dataset(file).error().message, file.string() + ": is not a folder");
}

}  // namespace
}  // namespace eg::io
