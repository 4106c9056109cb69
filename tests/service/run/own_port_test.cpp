#include "services/run/own_port.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "services/run/out_folder.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::run {
namespace {

using testing::HasSubstr;

constexpr char kUrl[] = "udpm://239.255.76.67:17655?ttl=0";

TEST(OwnPort, NoTwoAreTheSame) {
  const auto a = OwnPort::find();
  const auto b = OwnPort::find();
  ASSERT_TRUE(a && b);
  EXPECT_NE(a->url(), b->url());
  EXPECT_FALSE(OwnPort::take(a->url()));
}

TEST(OwnPort, IsFreeAgainWhenItsOwnerIsGone) {
  {
    const auto first = OwnPort::take(kUrl);
    ASSERT_TRUE(first);
    EXPECT_THAT(OwnPort::take(kUrl).error().message, HasSubstr("port 17655 is in use"));
  }
  EXPECT_TRUE(OwnPort::take(kUrl));
}

TEST(OwnPort, AUrlWithoutAUdpPortNeedsNone) {
  for (const char* url : {"memq://", "file:///x.lcm"}) {
    const auto first = OwnPort::take(url);
    const auto second = OwnPort::take(url);
    ASSERT_TRUE(first && second) << url;
    EXPECT_EQ(first->url(), url);
  }
}

TEST(OutFolder, RemovesResultsOfAnEarlierRunAndNothingElse) {
  const test::TemporaryFolder folder;
  const auto out = folder.path() / "a" / "out";
  ASSERT_TRUE(prepare_out_folder(out));
  std::ofstream(out / "mesh.ply") << "old";
  std::ofstream(out / "notes.txt") << "mine";
  const auto prepared = prepare_out_folder(out);
  ASSERT_TRUE(prepared);
  EXPECT_TRUE(prepared->path.is_absolute());
  EXPECT_FALSE(std::filesystem::exists(out / "mesh.ply"));
  EXPECT_TRUE(std::filesystem::exists(out / "notes.txt"));
}

TEST(OutFolder, BelongsToOneRunAtATime) {
  const test::TemporaryFolder folder;
  {
    const auto first = prepare_out_folder(folder.path());
    ASSERT_TRUE(first);
    folder.write("mesh.ply", "of the first run");
    EXPECT_THAT(prepare_out_folder(folder.path()).error().message, HasSubstr("is in use by another egraph-run"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "mesh.ply"));
  }
  EXPECT_TRUE(prepare_out_folder(folder.path()));
}

TEST(OutFolder, RemovesTheGraphsOfEverySession) {
  const test::TemporaryFolder folder;
  for (const char* name : {"graph-1.journal", "graph--7.journal", "graph-paper.txt"}) folder.write(name, "old");
  ASSERT_TRUE(prepare_out_folder(folder.path()));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "graph-1.journal"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "graph--7.journal")) << "of a log of session -7";
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "graph-paper.txt"));
}

TEST(OutFolder, SaysWhyItCannotBeMade) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("file", "");
  EXPECT_THAT(prepare_out_folder(file).error().message, HasSubstr(file.string()));
  EXPECT_THAT(prepare_out_folder(file / "out").error().message, HasSubstr(file.string()));
}

}  // namespace
}  // namespace eg::run
