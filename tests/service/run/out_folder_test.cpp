#include "services/run/out_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.hpp"

namespace eg::run {
namespace {

TEST(OutFolder, ResultsOfAnEarlierRunAreRemovedAndNothingElse) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "map");
  const auto file = [&](const char* name) { return folder.path() / name; };
  const auto old = {"trajectory.txt", "status.json",      "mesh.ply",        "mesh.0.ply",     "mesh.12.vdb",
                    "mapper.journal", "mapper.1.journal", "graph-7.journal", "map/sparse.map", "map/dense.1.map"};
  const auto others = {"notes.txt", "mesh.ply.bak", "mesh..ply",     "mesh.old.ply", "ply",
                       ".ply",      "0.ply",        "map/notes.txt", "map/mesh.ply"};
  for (const char* name : old) std::ofstream(file(name)) << "old";
  for (const char* name : others) std::ofstream(file(name)) << "kept";
  const auto prepared = prepare_out_folder(folder.path());
  ASSERT_TRUE(prepared) << prepared.error().message;
  for (const char* name : old) EXPECT_FALSE(std::filesystem::exists(file(name))) << name;
  for (const char* name : others) EXPECT_TRUE(std::filesystem::exists(file(name))) << name;
}

}  // namespace
}  // namespace eg::run
