#include "services/run/out_folder.hpp"

#include <array>
#include <fstream>
#include <system_error>

namespace eg::run {
namespace {

constexpr std::array kResultFiles = {
    "trajectory.txt",    "states.csv",        "keyframes.txt",   "egraph.json",       "map.ply",
    "mesh.ply",          "mesh.vdb",          "status.json",     "groundtruth.txt",   "picture.png",
    "log.txt",           "run.lcm",           "report.html",     "report_mesh_0.png", "report_mesh_1.png",
    "report_mesh_2.png", "report_mesh_3.png", "graph-1.journal", "mapper.journal",    "tracker.journal",
    "settings.yaml",     "map/sparse.map",    "map/dense.map",   "map.pcd",           "mesh.pcd"};

}  // namespace

base::Result<std::filesystem::path> prepare_out_folder(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) return base::fail("cannot make the output folder " + folder.string() + ": " + failure.message());
  for (const char* name : kResultFiles) {
    std::filesystem::remove(folder / name, failure);
    if (failure) return base::fail("cannot remove the old " + (folder / name).string() + ": " + failure.message());
  }
  const std::filesystem::path probe = folder / "log.txt";
  if (!std::ofstream(probe)) return base::fail("cannot write to the output folder " + folder.string());
  return std::filesystem::absolute(folder);
}

}  // namespace eg::run
