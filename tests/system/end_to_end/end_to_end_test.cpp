#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <thread>
#include <utility>

#include "common/eval/trajectory_errors.hpp"
#include "common/io/graph_json.hpp"
#include "common/io/ply.hpp"
#include "common/io/trajectory_file.hpp"
#include "common/procman/process_tree.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

/// All processes together, over LCM, on the synthetic room.
namespace eg {
namespace {

using namespace std::chrono_literals;
using test::file_bytes;
using test::Program;
using testing::HasSubstr;

std::vector<std::string> arguments(const std::filesystem::path& out, int frames, std::vector<std::string> more = {}) {
  std::vector<std::string> all = {"--dataset", "synthetic:room", "--frames", std::to_string(frames),
                                  "--out",     out.string()};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::int64_t line_count(const std::filesystem::path& file) {
  const std::string text = file_bytes(file);
  return std::count(text.begin(), text.end(), '\n');
}

class EndToEnd : public testing::Test {
 protected:
  void TearDown() override { EXPECT_TRUE(test::no_process_is_left()); }

  /// Waits until a run has finished some frames.
  static bool is_under_way(Program& run, const std::filesystem::path& out) {
    return run.wait_for_output("  tracking ") && std::filesystem::exists(out / "log.txt");
  }

  test::TemporaryFolder folder_;
};

/// What a robot's own services may be told by the environment.
constexpr std::pair<const char*, const char*> kForServices[] = {{"EGRAPH_ROBOTS", "red_,blue_"},
                                                                {"EGRAPH_STATE", "/no/such/folder"},
                                                                {"EGRAPH_TILES", "0/2"},
                                                                {"EGRAPH_LIVE", "OPENNI_FRAME"}};

// The two runs go on at the same time: they must not hear each other, nor what is meant for others.
TEST_F(EndToEnd, TracksEveryFrameAndRepeatsItselfExactly) {
  const auto a = folder_.path() / "a";
  const auto b = folder_.path() / "b";
  Program run_a("egraph-run", arguments(a, 60));
  for (const auto& [name, value] : kForServices) setenv(name, value, 1);
  Program run_b("egraph-run", arguments(b, 60));
  for (const auto& [name, value] : kForServices) unsetenv(name);
  ASSERT_EQ(run_a.wait(), 0) << run_a.output();
  ASSERT_EQ(run_b.wait(), 0) << run_b.output();

  for (const char* name : {"trajectory.txt", "states.csv", "keyframes.txt", "egraph.json", "map.ply", "mesh.ply",
                           "mesh.vdb", "status.json", "groundtruth.txt", "picture.png", "log.txt"}) {
    EXPECT_GT(file_bytes(a / name).size(), 0u) << name;
  }
  for (const char* name : {"trajectory.txt", "states.csv", "keyframes.txt", "egraph.json", "map.ply", "mesh.ply"}) {
    EXPECT_TRUE(file_bytes(a / name) == file_bytes(b / name)) << name << " differs from run to run";
  }

  const auto estimate = io::read_trajectory(a / "trajectory.txt");
  const auto truth = io::read_trajectory(a / "groundtruth.txt");
  ASSERT_TRUE(estimate && truth);
  EXPECT_EQ(estimate->size(), 60u);
  EXPECT_EQ(line_count(a / "states.csv"), 61);
  const auto errors = eval::evaluate_trajectory(*estimate, *truth);
  ASSERT_TRUE(errors);
  EXPECT_LT(errors->ate_m.rmse, 0.01);
  EXPECT_LT(errors->are_first_pose_deg.mean, 0.3);

  const auto graph = io::read_graph(a / "egraph.json");
  ASSERT_TRUE(graph) << graph.error().message;
  EXPECT_GE(graph->keyframes.size(), 2u);
  EXPECT_GE(graph->landmarks.size(), 2u);
  const auto mesh = io::read_ply(a / "mesh.ply");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_GT(mesh->triangles.size(), 1000u);
  EXPECT_THAT(run_a.output(), HasSubstr("ATE"));
}

TEST_F(EndToEnd, RunsInRealTimeWithoutTheMapper) {
  const auto out = folder_.path() / "out";
  Program run("egraph-run", arguments(out, 30, {"--realtime", "--no-mapper"}));
  ASSERT_EQ(run.wait(), 0) << run.output();
  EXPECT_GE(line_count(out / "trajectory.txt"), 2);
  EXPECT_FALSE(std::filesystem::exists(out / "mesh.ply"));
}

TEST_F(EndToEnd, WatchesTwoMappersThatShareTheSpace) {
  const auto out = folder_.path() / "out";
  const std::string two_mappers = std::string(EGRAPH_SOURCE_DIR) + "/procman/two_mappers.pmd";
  Program run("egraph-run", arguments(out, 10, {"--procman", two_mappers}));
  ASSERT_EQ(run.wait(), 0) << run.output();
  const std::string status = file_bytes(out / "status.json");
  for (const char* number : {"0", "1"}) {
    EXPECT_THAT(status, HasSubstr(std::string("\"mapper.") + number + "\": {"));
    const auto mesh = io::read_ply(out / (std::string("mesh.") + number + ".ply"));
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_GT(mesh->triangles.size(), 1000u) << number;
  }
}

TEST_F(EndToEnd, ALogHoldsAllMessagesAndGivesTheSameResultsAgain) {
  const auto out = folder_.path() / "out";
  const auto again = folder_.path() / "again";
  Program run("egraph-run", arguments(out, 30, {"--log"}));
  ASSERT_EQ(run.wait(), 0) << run.output();
  const std::string log = file_bytes(out / "run.lcm");
  for (const char* channel : {"RGBD", "FEATURES", "POSE", "KEYFRAME", "EGRAPH_UPDATE", "STATUS", "END_OF_STREAM"}) {
    EXPECT_THAT(log, HasSubstr(channel));
  }

  Program replay("egraph-run", {"--log-in", (out / "run.lcm").string(), "--out", again.string()});
  ASSERT_EQ(replay.wait(), 0) << replay.output();
  for (const char* name : {"trajectory.txt", "states.csv", "keyframes.txt", "egraph.json", "map.ply", "mesh.ply"}) {
    EXPECT_FALSE(file_bytes(again / name).empty()) << name;
    EXPECT_TRUE(file_bytes(out / name) == file_bytes(again / name)) << name << " differs from the recorded run";
  }
  EXPECT_THAT(replay.output(), HasSubstr("ATE")) << "the recorded run's ground truth lies beside the log";

  Program into_itself("egraph-run", {"--log-in", (out / "run.lcm").string(), "--out", out.string()});
  EXPECT_EQ(into_itself.wait(), 1);
  EXPECT_TRUE(file_bytes(out / "run.lcm") == log);
}

TEST_F(EndToEnd, AnInterruptionKeepsWhatWasComputed) {
  const auto out = folder_.path() / "out";
  Program run("egraph-run", arguments(out, 1000));
  ASSERT_TRUE(is_under_way(run, out)) << run.output();
  run.send_signal(SIGINT);
  EXPECT_EQ(run.wait(60s), 130) << run.output();
  EXPECT_TRUE(test::no_process_is_left(0s));
  EXPECT_GE(line_count(out / "trajectory.txt"), 1);
  for (const char* name : {"states.csv", "keyframes.txt", "egraph.json", "map.ply", "mesh.ply", "status.json"}) {
    EXPECT_TRUE(std::filesystem::exists(out / name)) << name;
  }
}

TEST_F(EndToEnd, AnInterruptionAtTheVeryStartLeavesNothingRunning) {
  for (const auto pause : {0ms, 50ms, 150ms, 400ms}) {
    Program run("egraph-run", arguments(folder_.path() / "out", 1000));
    ASSERT_TRUE(run.wait_for_output("in lockstep")) << run.output();
    std::this_thread::sleep_for(pause);
    run.send_signal(SIGINT);
    EXPECT_EQ(run.wait(60s), 130) << run.output();
    EXPECT_TRUE(test::no_process_is_left(0s));
  }
}

TEST_F(EndToEnd, KillingTheRunEndsTheServices) {
  const auto out = folder_.path() / "out";
  Program run("egraph-run", arguments(out, 1000));
  ASSERT_TRUE(is_under_way(run, out)) << run.output();
  run.send_signal(SIGKILL);
  EXPECT_EQ(run.wait(), 128 + SIGKILL);
  EXPECT_TRUE(test::no_process_is_left(15s));
}

TEST_F(EndToEnd, KilledServicesComeBackAndChangeNothing) {
  const auto undisturbed = folder_.path() / "undisturbed";
  const auto out = folder_.path() / "out";
  Program reference("egraph-run", arguments(undisturbed, 30));
  Program run("egraph-run", arguments(out, 30));
  ASSERT_TRUE(is_under_way(run, out)) << run.output();
  for (const char* service : {"tracker", "mapper", "egraph_server", "frame_source", "feature_extractor", "tracker"}) {
    const pid_t pid = test::service_pid(out / "log.txt", service);
    ASSERT_GT(pid, 0) << service;
    kill(pid, SIGKILL);
    std::this_thread::sleep_for(200ms);
  }
  ASSERT_EQ(run.wait(), 0) << run.output();
  ASSERT_EQ(reference.wait(), 0) << reference.output();
  EXPECT_THAT(file_bytes(out / "log.txt"), HasSubstr("tracker ended with signal 9 (Killed)"));
  for (const char* name : {"trajectory.txt", "states.csv", "keyframes.txt", "egraph.json", "map.ply", "mesh.ply"}) {
    EXPECT_TRUE(file_bytes(undisturbed / name) == file_bytes(out / name)) << name << " differs";
  }
}

TEST_F(EndToEnd, NamesAServiceThatEndsForGoodAndSavesTheRest) {
  const auto out = folder_.path() / "out";
  std::string configuration = file_bytes(EGRAPH_SOURCE_DIR "/procman/egraph.pmd");
  for (std::size_t at = 0; (at = configuration.find("auto_respawn = \"true\";", at)) != std::string::npos;) {
    configuration.erase(at, std::string_view("auto_respawn = \"true\";").size());
  }
  const auto file = folder_.write("once.pmd", configuration);
  Program run("egraph-run", arguments(out, 1000, {"--procman", file.string()}));
  ASSERT_TRUE(is_under_way(run, out)) << run.output();
  kill(test::service_pid(out / "log.txt", "tracker"), SIGKILL);
  EXPECT_EQ(run.wait(60s), 1);
  EXPECT_THAT(run.output(), HasSubstr("service tracker ended with signal 9 (Killed)"));
  EXPECT_TRUE(std::filesystem::exists(out / "egraph.json"));
  EXPECT_TRUE(std::filesystem::exists(out / "mesh.ply"));
}

TEST_F(EndToEnd, ASecondRunOnTheSamePortIsRefused) {
  const std::vector<std::string> url = {"--lcm-url", "udpm://239.255.76.67:17654?ttl=0&recv_buf_size=2097152"};
  Program first("egraph-run", arguments(folder_.path() / "first", 1000, url));
  ASSERT_TRUE(first.wait_for_output("in lockstep")) << first.output();
  Program second("egraph-run", arguments(folder_.path() / "second", 1000, url));
  EXPECT_EQ(second.wait(60s), 1);
  EXPECT_THAT(second.output(), HasSubstr("port 17654 is in use by another egraph-run"));
  first.send_signal(SIGINT);
  EXPECT_EQ(first.wait(60s), 130);
}

}  // namespace
}  // namespace eg
