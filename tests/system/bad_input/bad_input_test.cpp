#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/program.hpp"
#include "tests/support/recording.hpp"
#include "tests/support/temporary_folder.hpp"

/// What egraph-run says to input that it cannot use: one sentence, and an exit code that is not 0.
namespace eg {
namespace {

using test::file_bytes;
using test::Program;
using testing::HasSubstr;
namespace fs = std::filesystem;

class BadInput : public testing::Test {
 protected:
  BadInput() { test::write_recording(recording_, 4); }
  void TearDown() override { EXPECT_TRUE(test::no_process_is_left()); }

  /// The only error line of a run that must fail without starting anything.
  std::string error_of(const std::vector<std::string>& more, const std::string& dataset) {
    std::vector<std::string> arguments = {"--dataset", dataset, "--out", (folder_.path() / "out").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Program run("egraph-run", arguments);
    EXPECT_NE(run.wait(), 0);
    const std::string output = run.output();
    EXPECT_EQ(std::count(output.begin(), output.end(), '\n'), 1) << output;
    return output;
  }
  std::string error_of(const std::vector<std::string>& more = {}) { return error_of(more, recording_.string()); }

  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(recording_ / name, std::ios::binary) << bytes;
  }

  test::TemporaryFolder folder_;
  fs::path recording_ = folder_.path() / "recording";
};

TEST_F(BadInput, NoSuchFolder) {
  EXPECT_THAT(error_of({}, "/no/such/folder"), HasSubstr("/no/such/folder: no such folder"));
}

TEST_F(BadInput, AFolderWithoutImages) {
  fs::create_directories(folder_.path() / "empty");
  EXPECT_THAT(error_of({}, (folder_.path() / "empty").string()), HasSubstr("is no data set"));
}

TEST_F(BadInput, NoSuchSyntheticScene) { EXPECT_THAT(error_of({}, "synthetic:garden"), HasSubstr("'garden'")); }

TEST_F(BadInput, AnEmptyList) {
  write("rgb.txt", "# nothing\n");
  EXPECT_THAT(error_of(), HasSubstr("rgb.txt: names no images"));
}

TEST_F(BadInput, TimeStampsThatDoNotIncrease) {
  write("rgb.txt", "1.0 rgb/0.png\n1.1 rgb/1.png\n1.1 rgb/2.png\n");
  EXPECT_THAT(error_of(), HasSubstr("rgb.txt:3"));
}

TEST_F(BadInput, NoPairWithinTheTolerance) {
  write("depth.txt", "100.0 depth/0.png\n");
  EXPECT_THAT(error_of(), HasSubstr("no image of rgb.txt is within"));
}

TEST_F(BadInput, AnImageThatIsNone) {
  write("rgb/0.png", "this is text");
  EXPECT_THAT(error_of(), HasSubstr("rgb/0.png: file is neither PNG nor JPEG"));
}

TEST_F(BadInput, ATruncatedImage) {
  const std::string bytes = file_bytes(recording_ / "depth/0.png");
  write("depth/0.png", bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(error_of(), HasSubstr("depth/0.png: PNG is cut short"));
}

TEST_F(BadInput, DepthOfTheWrongType) {
  cv::imwrite((recording_ / "depth/0.png").string(), cv::Mat(480, 640, CV_8UC1, cv::Scalar(7)));
  EXPECT_THAT(error_of(), HasSubstr("depth/0.png"));
}

TEST_F(BadInput, DepthOfTheWrongSize) {
  cv::imwrite((recording_ / "depth/0.png").string(), cv::Mat(240, 320, CV_16UC1, cv::Scalar(5000)));
  EXPECT_THAT(error_of(), HasSubstr("depth/0.png"));
}

TEST_F(BadInput, AnUnknownCamera) {
  EXPECT_THAT(error_of({"--camera", "kinect9"}), testing::AllOf(HasSubstr("'kinect9'"), HasSubstr("tum_fr1")));
}

TEST_F(BadInput, NoCameraAtAll) {
  fs::remove(recording_ / "camera.yaml");
  EXPECT_THAT(error_of(), HasSubstr("--camera"));
}

TEST_F(BadInput, ACameraWithoutDepthScale) {
  std::string yaml = file_bytes(recording_ / "camera.yaml");
  const std::size_t key = yaml.find("depth_units_per_metre");
  yaml.erase(key, yaml.find('\n', key) - key + 1);
  write("camera.yaml", yaml);
  EXPECT_THAT(error_of(), HasSubstr("depth_units_per_metre"));
}

TEST_F(BadInput, AnOutputFolderThatCannotBe) {
  write("file", "");
  Program run("egraph-run", {"--dataset", "synthetic:room", "--out", (recording_ / "file" / "out").string()});
  EXPECT_EQ(run.wait(), 1);
  EXPECT_THAT(run.output(), HasSubstr("cannot make the output folder"));
}

TEST_F(BadInput, ResultsThatWouldReplaceWhatTheyAreMadeOf) {
  const auto refusal = [](const std::vector<std::string>& arguments) {
    Program run("egraph-run", arguments);
    EXPECT_EQ(run.wait(), 1);
    return run.output();
  };
  write("groundtruth.txt", "true");
  EXPECT_THAT(refusal({"--dataset", recording_.string(), "--out", recording_.string() + "/."}),
              HasSubstr("the recording is in the folder of --out"));
  EXPECT_EQ(file_bytes(recording_ / "groundtruth.txt"), "true");

  const fs::path out = folder_.write("out/map/sparse.map", "a map").parent_path().parent_path();
  const fs::path settings = folder_.write("out/settings.yaml", "tracker:\n");
  EXPECT_THAT(refusal({"--dataset", recording_.string(), "--out", out.string(), "--load", (out / "map").string()}),
              HasSubstr("--load and --out name the same folder"));
  EXPECT_THAT(refusal({"--dataset", recording_.string(), "--out", out.string(), "--config", settings.string()}),
              HasSubstr("settings.yaml would be replaced"));
  EXPECT_EQ(file_bytes(out / "map/sparse.map"), "a map");
  EXPECT_EQ(file_bytes(settings), "tracker:\n");
}

TEST_F(BadInput, NoRouteForMulticast) {
  if (std::system("unshare -n true 2>/dev/null") != 0) GTEST_SKIP() << "only root can make a network without routes";
  const fs::path said = folder_.path() / "said.txt";
  const std::string command = "unshare -n " EGRAPH_BIN_DIR "/egraph-run --dataset synthetic:room --out " +
                              (folder_.path() / "out").string() + " >" + said.string() + " 2>&1";
  EXPECT_NE(std::system(command.c_str()), 0);
  EXPECT_THAT(file_bytes(said), testing::AllOf(HasSubstr("no multicast route"), HasSubstr("ip route add")));
}

TEST_F(BadInput, AProcmanConfigurationWithAMistake) {
  write("x.pmd", "cmd \"a\" { exec = \"x\" }");
  EXPECT_THAT(error_of({"--procman", (recording_ / "x.pmd").string()}), HasSubstr("x.pmd:1:22: expected ';'"));
}

TEST_F(BadInput, AnUnknownConfigurationKey) {
  write("config.yaml", "tracker:\n  serach:\n    radius: 20\n");
  Program run("egraph-run", {"--dataset", recording_.string(), "--out", (folder_.path() / "out").string(), "--config",
                             (recording_ / "config.yaml").string()});
  EXPECT_EQ(run.wait(), 1);
  EXPECT_THAT(run.output(), HasSubstr("config.yaml:2: unknown key 'serach'; did you mean 'search'?"));
}

TEST_F(BadInput, ASingleCorruptFrameIsReportedAndSkipped) {
  write("rgb/2.png", "this is text");
  Program run("egraph-run", {"--dataset", recording_.string(), "--out", (folder_.path() / "out").string()});
  EXPECT_EQ(run.wait(), 0) << run.output();
  EXPECT_THAT(run.output(), HasSubstr("rgb/2.png: file is neither PNG nor JPEG"));
  EXPECT_THAT(run.output(), HasSubstr("1 unreadable"));
}

}  // namespace
}  // namespace eg
