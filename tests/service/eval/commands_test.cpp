#include "services/eval/commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <set>

#include "common/geometry/so3.hpp"
#include "common/io/graph_json.hpp"
#include "common/io/ply.hpp"
#include "common/io/text_file.hpp"
#include "common/io/trajectory_file.hpp"
#include "common/synthetic/sequence.hpp"
#include "services/eval/report_command.hpp"
#include "tests/support/recording.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::service {
namespace {

using testing::HasSubstr;

class EvalCommands : public testing::Test {
 protected:
  EvalCommands() {
    std::vector<geometry::StampedPose> reference, estimate;
    const geometry::Pose motion{geometry::so3_exp({0.3, 0.2, 0.1}), {1, 2, 3}};
    egraph::GraphWithEdges graph;
    for (int i = 0; i < 60; ++i) {
      const geometry::Pose pose{geometry::so3_exp({0, 0.05 * i, 0}), {0.02 * i, 0.001 * i * i, 0}};
      estimate.push_back({i / 30.0, pose});
      reference.push_back({i / 30.0, motion * pose});
      if (i % 20 != 0) continue;
      egraph::KeyframeNode& keyframe = graph.keyframes.emplace_back();
      keyframe.id = {i / 20};
      keyframe.utime = i * 1000000LL / 30;
      keyframe.world_from_camera = pose;
    }
    graph.edges = {{{0}, {1}, {}}, {{0}, {2}, {}}};
    EXPECT_TRUE(io::write_trajectory(file("est.txt"), estimate).has_value());
    EXPECT_TRUE(io::write_trajectory(file("gt.txt"), reference).has_value());
    EXPECT_TRUE(io::write_graph(file("egraph.json"), graph).has_value());

    io::PlyData mesh;
    mesh.vertices = {{0, 1, 0}, {2, 1, 0}, {0, 1, 2}};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_TRUE(io::write_ply(file("mesh.ply"), io::view_of(mesh)).has_value());
    for (Eigen::Vector3f& v : mesh.vertices) v = (motion * v.cast<double>().eval()).cast<float>();
    EXPECT_TRUE(io::write_ply(file("ref.ply"), io::view_of(mesh)).has_value());
  }
  [[nodiscard]] std::filesystem::path file(const char* name) const { return folder_.path() / name; }

  test::TemporaryFolder folder_;
};

TEST_F(EvalCommands, TheCloudOfTrueDepthsLiesOnTheScene) {
  const auto recording = folder_.path() / "room";
  test::write_recording(recording, 3);
  const auto report = write_depth_cloud({recording, {}, {}}, {0.05, 0.0}, file("cloud.ply"));
  ASSERT_TRUE(report.has_value()) << report.error().message;
  EXPECT_EQ(report->json["images"], 3);
  EXPECT_EQ(report->json["without_pose"], 0);
  const auto cloud = io::read_ply(file("cloud.ply"));
  ASSERT_TRUE(cloud.has_value());
  EXPECT_GT(cloud->vertices.size(), 1000U);
  EXPECT_EQ(cloud->colours.size(), cloud->vertices.size());
  const auto sequence = synthetic::SyntheticSequence::make({}).value();
  std::set<std::array<int, 3>> cubes;
  double farthest = 0.0;
  for (const Eigen::Vector3f& point : cloud->vertices) {
    farthest = std::max(farthest, synthetic::clearance(sequence.scene(), point.cast<double>()));
    const Eigen::Vector3i cube = (point / 0.05F).array().floor().cast<int>();
    cubes.insert({cube.x(), cube.y(), cube.z()});
  }
  EXPECT_LT(farthest, 0.002) << "steps of the depth images";
  EXPECT_GT(static_cast<double>(cubes.size()), 0.999 * static_cast<double>(cloud->vertices.size()));

  const auto near = write_depth_cloud({recording, {}, {}}, {0.05, 1.5}, file("near.ply"));
  ASSERT_TRUE(near.has_value()) << near.error().message;
  EXPECT_LT(near->json["points"], report->json["points"]);

  std::filesystem::remove(recording / "groundtruth.txt");
  const auto without = write_depth_cloud({recording, {}, {}}, {}, file("none.ply"));
  ASSERT_FALSE(without.has_value());
  EXPECT_THAT(without.error().message, HasSubstr("has no true poses"));
  const std::vector<geometry::StampedPose> later = {{1000.0, {}}};
  ASSERT_TRUE(io::write_trajectory(file("later.txt"), later).has_value());
  EXPECT_THAT(write_depth_cloud({recording, {}, file("later.txt")}, {}, file("none.ply")).error().message,
              HasSubstr("no pose is at the time of an image"));
}

TEST_F(EvalCommands, EdgesOfBothGraphs) {
  const auto report = render_edges(file("egraph.json"), false, file("edges.png"));
  ASSERT_TRUE(report.has_value()) << report.error().message;
  EXPECT_EQ(report->json["edges"], 2);
  EXPECT_EQ(report->json["covisibility_edges"], 0);
  const cv::Mat picture = cv::imread(file("edges.png").string());
  ASSERT_FALSE(picture.empty());
  const auto ink = [&](const cv::Mat& half) { return cv::countNonZero(half.reshape(1) != 255); };
  EXPECT_GT(ink(picture.colRange(0, picture.cols / 2).clone()),
            ink(picture.colRange(picture.cols / 2, picture.cols).clone()));
}

TEST_F(EvalCommands, Drift) {
  const auto report = report_drift(file("est.txt"), file("gt.txt"));
  ASSERT_TRUE(report.has_value()) << report.error().message;
  EXPECT_THAT(report->table, HasSubstr("rotation error grows by"));
  EXPECT_NEAR(report->json["rotation_slope_deg_per_min"].get<double>(), 0.0, 1e-3);
  EXPECT_THAT(report_drift(file("est.txt"), file("none.txt")).error().message, HasSubstr("none.txt"));
}

TEST_F(EvalCommands, Trajectory) {
  const auto report = report_trajectory(file("est.txt"), file("gt.txt"));
  ASSERT_TRUE(report.has_value()) << report.error().message;
  EXPECT_THAT(report->table, HasSubstr("60 of 60 estimated poses matched, 100.0 %"));
  EXPECT_EQ(report->json["matched_frames"], 60);
  EXPECT_LT(report->json["ate_rmse_m"].get<double>(), 1e-6);
  EXPECT_LT(report->json["are_mean_deg"].get<double>(), 1e-4);
  EXPECT_EQ(report->json["rpe_rotation_deg"]["count"], 30);
}

TEST_F(EvalCommands, Graph) {
  const auto report = report_graph(file("egraph.json"), file("gt.txt"), "synthetic");
  ASSERT_TRUE(report.has_value()) << report.error().message;
  EXPECT_EQ(report->json["edges"], 2);
  EXPECT_EQ(report->json["overlapping_deg"]["count"], 1);      // 57 degrees apart
  EXPECT_EQ(report->json["non_overlapping_deg"]["count"], 1);  // 115 degrees apart
  EXPECT_LT(report->json["edge_rotation_mean_deg"].get<double>(), 1e-4);
  EXPECT_THAT(report_graph(file("egraph.json"), file("gt.txt"), "nikon").error().message, HasSubstr("unknown camera"));
}

TEST_F(EvalCommands, MeshWithAndWithoutAlignment) {
  const auto unaligned = report_mesh(file("mesh.ply"), file("ref.ply"), std::nullopt);
  ASSERT_TRUE(unaligned.has_value());
  EXPECT_GT(unaligned->json["accuracy_mean_m"].get<double>(), 0.5);
  const auto aligned = report_mesh(file("mesh.ply"), file("ref.ply"), MeshAlignment{file("est.txt"), file("gt.txt")});
  ASSERT_TRUE(aligned.has_value());
  EXPECT_LT(aligned->json["accuracy_mean_m"].get<double>(), 1e-5);
  EXPECT_LT(aligned->json["completeness_mean_m"].get<double>(), 1e-5);
}

TEST_F(EvalCommands, Picture) {
  const PictureFiles files{file("mesh.ply"), file("est.txt"), file("gt.txt"), file("egraph.json")};
  const auto report = render_picture(files, false, file("picture.png"));
  ASSERT_TRUE(report.has_value()) << report.error().message;
  EXPECT_THAT(report->table, HasSubstr("1280x1280 picture of 1 triangles, 60 poses and 3 keyframes"));
  EXPECT_EQ(cv::imread(file("picture.png").string()).size(), cv::Size(1280, 1280));
  EXPECT_THAT(render_picture({}, false, file("p.png")).error().message, HasSubstr("needs --mesh or --trajectory"));
  EXPECT_THAT(render_picture(files, false, "/no/such/p.png").error().message,
              HasSubstr("/no/such/p.png: cannot be written"));
}

TEST_F(EvalCommands, BadFilesAreNamed) {
  folder_.write("late.txt", "1000.0 0 0 0 0 0 0 1\n1001.0 0 0 0 0 0 0 1\n");
  const auto late = report_trajectory(file("late.txt"), file("gt.txt"));
  EXPECT_EQ(late.error().message,
            file("late.txt").string() + " against " + file("gt.txt").string() +
                ": only 0 of 2 estimated poses have a reference pose within 20 ms; at least 2 are needed");
  EXPECT_THAT(report_trajectory(file("none"), file("gt.txt")).error().message, HasSubstr("none: cannot be read"));
  EXPECT_THAT(report_graph(file("gt.txt"), file("gt.txt"), "icl").error().message,
              HasSubstr("gt.txt: is no valid JSON"));
  EXPECT_THAT(report_mesh(file("gt.txt"), file("ref.ply"), std::nullopt).error().message, HasSubstr("is no PLY file"));
}

std::string status_json(int frames_with_pose) {
  return R"({"input": "x", "mode": "lockstep", "result": "complete", "failure": "", "frames_done": 60,
  "keyframes": 3, "wall_seconds": 1.0, "frames_with_pose": )" +
         std::to_string(frames_with_pose) + "}";
}

TEST_F(EvalCommands, AReportNeedsTheFilesThatItIsGiven) {
  EXPECT_THAT(report_run({folder_.path(), {}, {}}, false).error().message, HasSubstr("status.json: cannot be read"));
  folder_.write("status.json", status_json(60));
  EXPECT_THAT(report_run({folder_.path(), file("no.txt"), {}}, false).error().message, HasSubstr("no.txt: cannot be"));
  EXPECT_THAT(report_run({folder_.path(), {}, file("no.yaml")}, false).error().message,
              HasSubstr("no.yaml: cannot be"));
  const auto config = folder_.write("all.yaml", "tracker:\n  search:\n    radius: 19\n");
  const auto report = report_run({folder_.path(), file("gt.txt"), config}, false);
  ASSERT_TRUE(report.has_value()) << report.error().message;
  EXPECT_THAT(*io::read_file(file("report.html")), HasSubstr("radius: 19"));
}

TEST_F(EvalCommands, ARunWithoutAPoseHasAReportToo) {
  folder_.write("status.json", status_json(0));
  folder_.write("trajectory.txt", "# timestamp tx ty tz qx qy qz qw\n");
  const auto report = report_run({folder_.path(), file("gt.txt"), {}}, false);
  EXPECT_TRUE(report.has_value()) << report.error().message;
}

/// What a shell sees.
int run(const std::string& arguments, std::string* output = nullptr) {
  const std::string command = std::string(EGRAPH_BIN_DIR) + "/egraph-eval " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  if (output != nullptr) *output = text;
  return pclose(pipe);
}

TEST_F(EvalCommands, ExitCodesAndOneSentence) {
  const std::string est = file("est.txt").string(), gt = file("gt.txt").string();
  std::string output;
  EXPECT_EQ(run("trajectory " + est + " " + gt + " --json", &output), 0);
  EXPECT_EQ(nlohmann::json::parse(output)["matched_frames"], 60);
  EXPECT_NE(run("trajectory " + est + " /no/such/file", &output), 0);
  EXPECT_EQ(output, "egraph-eval: /no/such/file: cannot be read: No such file or directory\n");
  EXPECT_NE(run("trajectory " + est, &output), 0);
  EXPECT_NE(run("", &output), 0);
  EXPECT_EQ(run("--help", &output), 0);
  EXPECT_NE(run("table " + folder_.path().string() + " --out x --frames -1", &output), 0);
  EXPECT_THAT(output, HasSubstr("--frames: Value -1 not in range 0 to 9223372036854775807"));
}

}  // namespace
}  // namespace eg::service
