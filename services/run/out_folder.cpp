#include "services/run/out_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "common/io/atomic_file.hpp"

namespace eg::run {
namespace {

constexpr std::array<std::string_view, 24> kResultFiles = {
    "trajectory.txt",    "states.csv",        "keyframes.txt",  "egraph.json",       "map.ply",
    "mesh.ply",          "mesh.vdb",          "status.json",    "groundtruth.txt",   "picture.png",
    "log.txt",           "run.lcm",           "report.html",    "report_mesh_0.png", "report_mesh_1.png",
    "report_mesh_2.png", "report_mesh_3.png", "mapper.journal", "tracker.journal",   kSettingsFile,
    "map/sparse.map",    "map/dense.map",     "map.pcd",        "mesh.pcd"};

constexpr char kMapFolder[] = "map";

/// The server's graph of any session, which a run would go on with.
bool is_graph_journal(const std::string& name) { return name.starts_with("graph-") && name.ends_with(".journal"); }

/// Without the number of a mapper's share of the space: mesh.0.ply is a mesh.ply.
std::string without_share(std::string name) {
  const std::size_t end = name.rfind('.');
  if (end == std::string::npos) return name;
  const std::size_t dot = name.find_last_not_of("0123456789", end - 1);
  if (dot != std::string::npos && name[dot] == '.' && dot + 1 < end) name.erase(dot, end - dot);
  return name;
}

/// `name`: relative to the output folder.
bool is_result(const std::string& name) {
  return is_graph_journal(name) ||
         std::find(kResultFiles.begin(), kResultFiles.end(), without_share(name)) != kResultFiles.end();
}

base::Status remove_old(const std::filesystem::path& file) {
  std::error_code failure;
  std::filesystem::remove(file, failure);
  return failure ? base::fail("cannot remove the old " + file.string() + ": " + failure.message()) : base::Status();
}

/// `prefix`: the folder's name in those of results.
base::Status remove_results(const std::filesystem::path& folder, const std::string& prefix) {
  std::error_code failure;
  std::vector<std::filesystem::path> old;
  for (std::filesystem::directory_iterator it(folder, failure), end; !failure && it != end; it.increment(failure)) {
    if (is_result(prefix + it->path().filename().string())) old.push_back(it->path());
  }
  if (failure) return base::fail("cannot read the output folder " + folder.string() + ": " + failure.message());
  for (const auto& file : old) {
    if (auto removed = remove_old(file); !removed) return removed;
  }
  return {};
}

}  // namespace

base::Result<OutFolder> prepare_out_folder(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) return base::fail("cannot make the output folder " + folder.string() + ": " + failure.message());
  if (const auto writable = io::check_writable(folder); !writable) return tl::make_unexpected(writable.error());
  procman::FileDescriptor lock(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (flock(lock.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return base::fail("the output folder " + folder.string() +
                      " is in use by another egraph-run; choose another for --out");
  }
  if (const auto removed = remove_results(folder, ""); !removed) return tl::make_unexpected(removed.error());
  if (std::filesystem::is_directory(folder / kMapFolder, failure)) {
    const auto removed = remove_results(folder / kMapFolder, std::string(kMapFolder) + '/');
    if (!removed) return tl::make_unexpected(removed.error());
  }
  return OutFolder{std::filesystem::absolute(folder), std::move(lock)};
}

}  // namespace eg::run
