#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "common/base/random.hpp"
#include "common/eval/trajectory_errors.hpp"
#include "common/geometry/camera_model.hpp"
#include "common/io/trajectory_file.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

/// Feature-level data instead of images: frame source, tracker and server over LCM.
namespace eg {
namespace {

using testing::HasSubstr;

constexpr int kFrames = 40;

/// A camera that walks sideways along 200 points, measured to one pixel.
void write_recording(const std::filesystem::path& folder) {
  const geometry::CameraModel camera = *geometry::find_camera("icl");
  base::Random random(1);
  std::vector<geometry::StampedPose> poses;
  for (int frame = 0; frame < kFrames; ++frame)
    poses.push_back({frame / 30.0, {Eigen::Matrix3d::Identity(), {0.02 * frame, 0, 0}}});
  ASSERT_TRUE(io::write_trajectory(folder / "ground_truth.txt", poses));
  std::FILE* landmarks = std::fopen((folder / "point_landmarks.txt").c_str(), "w");
  std::FILE* sequence = std::fopen((folder / "venom_sequence.txt").c_str(), "w");
  ASSERT_TRUE(landmarks != nullptr && sequence != nullptr);
  for (int point = 0; point < 200; ++point) {
    const Eigen::Vector3d position(random.uniform(-1, 2), random.uniform(-1, 1), random.uniform(2, 4));
    std::fprintf(landmarks, "%d %.6f %.6f %.6f\n", point, position.x(), position.y(), position.z());
    for (int frame = 0; frame < kFrames; ++frame) {
      const geometry::Pose camera_from_world = poses[static_cast<std::size_t>(frame)].world_from_camera.inverse();
      const Eigen::Vector2d noise(random.normal(), random.normal());
      const Eigen::Vector2d pixel = camera.project(camera_from_world * position) + noise;
      if (camera.contains(pixel))
        std::fprintf(sequence, "MappointFrameAsso: %d %d %.3f %.3f\n", point, frame, pixel.x(), pixel.y());
    }
  }
  std::fclose(landmarks);
  std::fclose(sequence);
}

TEST(Observations, AreTrackedAndRepeatThemselvesExactly) {
  const test::TemporaryFolder folder;
  write_recording(folder.path());
  const auto run = [&](const std::string& out) {
    test::Program program("egraph-run", {"--observations", folder.path().string(), "--camera", "icl", "--out",
                                         (folder.path() / out).string()});
    EXPECT_EQ(program.wait(), 0) << program.output();
    return program.output();
  };
  EXPECT_THAT(run("a"), HasSubstr("ATE"));
  run("b");
  for (const char* name : {"trajectory.txt", "states.csv", "egraph.json"}) {
    EXPECT_GT(test::file_bytes(folder.path() / "a" / name).size(), 0U) << name;
    EXPECT_EQ(test::file_bytes(folder.path() / "a" / name), test::file_bytes(folder.path() / "b" / name)) << name;
  }
  const auto estimate = io::read_trajectory(folder.path() / "a/trajectory.txt");
  const auto truth = io::read_trajectory(folder.path() / "a/groundtruth.txt");
  ASSERT_TRUE(estimate && truth);
  EXPECT_EQ(estimate->size(), static_cast<std::size_t>(kFrames));
  const auto errors = eval::evaluate_trajectory(*estimate, *truth);
  ASSERT_TRUE(errors);
  EXPECT_LT(errors->ate_m.rmse, 0.01);
  EXPECT_TRUE(test::no_process_is_left());
}

TEST(Observations, WrongOnesAreRefusedBeforeAnythingStarts) {
  const test::TemporaryFolder folder;
  write_recording(folder.path());
  folder.write("venom_sequence.txt", "MappointFrameAsso: 1 1 3\n");
  test::Program bad_line("egraph-run", {"--observations", folder.path().string(), "--camera", "icl", "--out",
                                        (folder.path() / "out").string()});
  EXPECT_EQ(bad_line.wait(), 1);
  EXPECT_THAT(bad_line.output(), HasSubstr("venom_sequence.txt:1: expected 'MappointFrameAsso: point frame u v'"));
  test::Program no_camera("egraph-run",
                          {"--observations", folder.path().string(), "--out", (folder.path() / "out").string()});
  EXPECT_EQ(no_camera.wait(), 1);
  EXPECT_THAT(no_camera.output(), HasSubstr("--camera"));
  test::Program two_inputs("egraph-run", {"--observations", folder.path().string(), "--dataset", "synthetic:room",
                                          "--out", (folder.path() / "out").string()});
  EXPECT_NE(two_inputs.wait(), 0);
}

}  // namespace
}  // namespace eg
