#include "common/io/camera_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace eg::io {
namespace {

using testing::HasSubstr;

constexpr char kCamera[] =
    "width: 320\nheight: 240\nfx: 250.5\nfy: -249.5\ncx: 159.5\ncy: 119.5\n"
    "distortion: [0.1, -0.2, 0.01, 0, 0.3]\ndepth_units_per_metre: 1000\nfps: 15\n";

std::string without_line(std::string_view text, std::string_view key) {
  std::string result(text);
  const std::size_t begin = result.find(key);
  return result.erase(begin, result.find('\n', begin) + 1 - begin);
}

TEST(ReadCamera, KnowsNames) {
  EXPECT_EQ(read_camera("tum_fr3")->fx, 535.4);
  EXPECT_EQ(read_camera("icl")->fy, -480.0);
}

TEST(ReadCamera, ReadsFiles) {
  test::TemporaryFolder folder;
  const auto camera = read_camera(folder.write("mine.yaml", kCamera).string());
  ASSERT_TRUE(camera.has_value()) << camera.error().message;
  EXPECT_EQ(camera->name, "mine");
  EXPECT_EQ(camera->width, 320);
  EXPECT_EQ(camera->fy, -249.5);
  EXPECT_EQ(camera->distortion[4], 0.3);
  EXPECT_EQ(camera->depth_units_per_metre, 1000);

  const auto plain = read_camera(folder.write("plain.yaml", without_line(kCamera, "distortion")).string());
  ASSERT_TRUE(plain.has_value()) << plain.error().message;
  EXPECT_FALSE(plain->has_distortion());
}

TEST(ReadCamera, WhatIsWrittenIsRead) {
  test::TemporaryFolder folder;
  for (const std::string& name : geometry::camera_names()) {
    const auto file = folder.path() / (name + ".yaml");
    ASSERT_TRUE(write_camera(file, *read_camera(name)).has_value());
    EXPECT_EQ(*read_camera(file.string()), *read_camera(name));
  }
}

TEST(ReadCamera, SaysWhatIsWrong) {
  test::TemporaryFolder folder;
  EXPECT_EQ(read_camera("tum_fr4").error().message,
            "unknown camera 'tum_fr4'; known: icl, tum_fr1, tum_fr2, tum_fr3, synthetic, or a YAML file");
  EXPECT_THAT(read_camera("/no/such.yaml").error().message, HasSubstr("/no/such.yaml: cannot be read"));
  const auto error = [&](const std::string& yaml) {
    const auto camera = read_camera(folder.write("c.yaml", yaml).string());
    EXPECT_FALSE(camera.has_value()) << yaml;
    return camera ? "" : camera.error().message;
  };
  EXPECT_THAT(error(without_line(kCamera, "depth_units")),
              HasSubstr("c.yaml:1: key 'depth_units_per_metre' is missing: the depth scale is never guessed"));
  EXPECT_THAT(error(without_line(kCamera, "fps")), HasSubstr("key 'fps' is missing"));
  EXPECT_THAT(error(std::string(kCamera) + "depth_scale: 5000\n"), HasSubstr("c.yaml:10: unknown key 'depth_scale'"));
  EXPECT_THAT(error(without_line(kCamera, "fy") + "fy: 0\n"), HasSubstr("c.yaml: camera fy must be"));
  EXPECT_THAT(error(without_line(kCamera, "depth_units") + "depth_units_per_metre: 0\n"),
              HasSubstr("c.yaml: camera depth_units_per_metre must be positive"));
  EXPECT_THAT(error(without_line(kCamera, "width") + "width: 640.5\n"), HasSubstr("'width' must be an integer"));
}

TEST(ResolveCamera, OptionThenFileThenName) {
  test::TemporaryFolder folder;
  const auto dataset = folder.path() / "rgbd_dataset_freiburg1_xyz";
  std::filesystem::create_directories(dataset);
  EXPECT_EQ(resolve_camera(dataset, std::nullopt)->camera.name, "tum_fr1");
  EXPECT_EQ(resolve_camera(dataset, std::nullopt)->how, "camera tum_fr1, by the folder's name");
  folder.write("rgbd_dataset_freiburg1_xyz/camera.yaml", kCamera);
  EXPECT_EQ(resolve_camera(dataset, std::nullopt)->camera.width, 320);
  EXPECT_EQ(resolve_camera(dataset, "icl")->camera.name, "icl");
  EXPECT_THAT(resolve_camera(dataset, "nikon").error().message, HasSubstr("unknown camera 'nikon'"));
  folder.write("rgbd_dataset_freiburg1_xyz/camera.yaml", "width: 3");
  EXPECT_THAT(resolve_camera(dataset, std::nullopt).error().message,
              HasSubstr("camera.yaml:1: key 'height' is missing"));
}

TEST(ResolveCamera, ByFolderName) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"/data/tum_fr3_structure_notexture_far", "tum_fr3"},
      {"/data/rgbd_dataset_freiburg2_desk/", "tum_fr2"},
      {"/data/FR1/xyz", "tum_fr1"},
      {"/data/icl_office_kt0", "icl"},
      {"/data/icl_office_kt0_clip/.", "icl"},
      {"/data/living_room_traj2_frei_png", "icl"},
      {"/data/livingroom2", "icl"},
      {"/data/OfficeRoom/kt1", "icl"},
      {"/data/traj3_frei_png", "icl"},
      {"/data/of_kt3", "icl"},
      {"/data/lr_kt1/x", "icl"},
  };
  for (const auto& [path, camera] : cases) {
    const auto resolved = resolve_camera(path, std::nullopt);
    ASSERT_TRUE(resolved.has_value()) << path;
    EXPECT_EQ(resolved->camera.name, camera) << path;
  }
}

TEST(ResolveCamera, DoesNotGuessFromOtherNames) {
  for (const char* path : {"/data/my_kitchen", "/fr1/a/b", "/data/freiburg10", "/data/bicycle", "/data/half_kt0"}) {
    const auto resolved = resolve_camera(path, std::nullopt);
    ASSERT_FALSE(resolved.has_value()) << path;
    EXPECT_THAT(resolved.error().message, HasSubstr("give --camera NAME or --camera FILE.yaml"));
  }
}

}  // namespace
}  // namespace eg::io
