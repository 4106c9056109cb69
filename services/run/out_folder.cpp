#include "services/run/out_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/io/atomic_file.hpp"

namespace eg::run {
namespace {

constexpr std::array kResultFiles = {"trajectory.txt",    "states.csv",        "keyframes.txt",     "egraph.json",
                                     "map.ply",           "mesh.ply",          "mesh.vdb",          "status.json",
                                     "groundtruth.txt",   "picture.png",       "log.txt",           "run.lcm",
                                     "report.html",       "report_mesh_0.png", "report_mesh_1.png", "report_mesh_2.png",
                                     "report_mesh_3.png", "mapper.journal",    "tracker.journal",   kSettingsFile,
                                     "map/sparse.map",    "map/dense.map",     "map.pcd",           "mesh.pcd"};

/// The server's graph of any session, which a run would go on with.
bool is_graph_journal(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with("graph-") && name.ends_with(".journal");
}

base::Status remove_old(const std::filesystem::path& file) {
  std::error_code failure;
  std::filesystem::remove(file, failure);
  return failure ? base::fail("cannot remove the old " + file.string() + ": " + failure.message()) : base::Status();
}

base::Status remove_graph_journals(const std::filesystem::path& folder) {
  std::error_code failure;
  std::vector<std::filesystem::path> journals;
  for (std::filesystem::directory_iterator it(folder, failure), end; !failure && it != end; it.increment(failure)) {
    if (is_graph_journal(it->path())) journals.push_back(it->path());
  }
  if (failure) return base::fail("cannot read the output folder " + folder.string() + ": " + failure.message());
  for (const auto& journal : journals) {
    if (auto removed = remove_old(journal); !removed) return removed;
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
  for (const char* name : kResultFiles) {
    if (const auto removed = remove_old(folder / name); !removed) return tl::make_unexpected(removed.error());
  }
  if (const auto removed = remove_graph_journals(folder); !removed) return tl::make_unexpected(removed.error());
  return OutFolder{std::filesystem::absolute(folder), std::move(lock)};
}

}  // namespace eg::run
