#include "common/io/atomic_file.hpp"

#include <gtest/gtest.h>

#include "common/io/text_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::io {
namespace {

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(AtomicFile, WritesAndReplaces) {
  test::TemporaryFolder folder;
  const auto path = folder.path() / "f";
  const std::string bytes("a\0b\n", 4);
  ASSERT_TRUE(write_file_atomically(path, bytes).has_value());
  EXPECT_EQ(*read_file(path), bytes);
  ASSERT_TRUE(write_file_atomically(path, "").has_value());
  EXPECT_EQ(*read_file(path), "");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(CheckWritable, SaysWhyNotAndLeavesNothing) {
  test::TemporaryFolder folder;
  EXPECT_TRUE(check_writable(folder.path()).has_value());
  EXPECT_EQ(files_in(folder.path()), 0U);
  const auto status = check_writable("/proc/self/task");
  ASSERT_FALSE(status.has_value());
  EXPECT_TRUE(status.error().message.starts_with("/proc/self/task: cannot be written to: ")) << status.error().message;
}

TEST(AtomicFile, FailureKeepsTheOldFileAndLeavesNothing) {
  test::TemporaryFolder folder;
  folder.write("target/inside", "kept");
  // A folder that is not empty cannot be replaced by a file.
  const auto status = write_file_atomically(folder.path() / "target", "new");
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().message, (folder.path() / "target").string() + ": cannot be written: Is a directory");
  EXPECT_EQ(files_in(folder.path()), 1U);
  EXPECT_EQ(*read_file(folder.path() / "target/inside"), "kept");
}

}  // namespace
}  // namespace eg::io
