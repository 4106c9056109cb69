#include "services/run/input.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temporary_folder.hpp"

namespace eg::run {
namespace {

/// The name of a camera stays one, though a folder here may be called like it (`--out icl`).
TEST(Input, AFolderDoesNotHideACameraOfItsName) {
  const test::TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::create_directory(folder.path() / "icl");
  std::filesystem::current_path(folder.path());
  RunOptions options;
  options.dataset = "synthetic:room";
  options.camera = "icl";
  const auto input = inspect_input(options);
  std::filesystem::current_path(before);
  ASSERT_TRUE(input.has_value()) << input.error().message;
  EXPECT_EQ(input->camera, "icl");
}

}  // namespace
}  // namespace eg::run
