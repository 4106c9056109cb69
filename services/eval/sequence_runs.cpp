#include "services/eval/sequence_runs.hpp"

#include <algorithm>

#include "common/io/dataset.hpp"
#include "common/io/trajectory_file.hpp"
#include "common/procman/run_program.hpp"

namespace eg::service {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxSearchDepth = 4;

bool holds(const fs::path& folder, const char* name) {
  std::error_code ignored;
  return fs::exists(folder / name, ignored);
}

/// The known sequence that `folder` is, if it is one.
const eval::KnownSequence* sequence_in(const fs::path& folder) {
  const std::string path = fs::absolute(folder).lexically_normal().string();
  if (holds(folder, "venom_sequence.txt")) return eval::find_sequence(path, true);
  const bool images = (holds(folder, "rgb") && holds(folder, "depth")) || holds(folder, "rgb.txt");
  return images ? eval::find_sequence(path, false) : nullptr;
}

/// Where the true poses are; egraph-run writes those of recordings that hold their own.
base::Result<fs::path> ground_truth_of(const FoundSequence& found, const fs::path& out) {
  if (found.sequence->observations) return out / "groundtruth.txt";
  const auto dataset = io::open_dataset(found.folder);
  if (!dataset) return tl::make_unexpected(dataset.error());
  if (dataset->ground_truth.empty()) return base::fail(found.folder.string() + ": has no ground truth");
  return dataset->ground_truth;
}

base::Status run_egraph(const FoundSequence& found, const RunPlan& plan, const fs::path& out) {
  const fs::path programs = fs::read_symlink("/proc/self/exe").parent_path();
  std::vector<std::string> words = {(programs / "egraph-run").string(),
                                    found.sequence->observations ? "--observations" : "--dataset",
                                    found.folder.string(),
                                    "--camera",
                                    found.sequence->camera,
                                    "--out",
                                    out.string(),
                                    "--no-mapper"};
  if (plan.frames > 0) words.insert(words.end(), {"--frames", std::to_string(plan.frames)});
  if (!plan.config.empty()) words.insert(words.end(), {"--config", plan.config.string()});
  std::error_code failure;
  fs::create_directories(out, failure);
  if (failure) return base::fail("cannot make the folder " + out.string() + ": " + failure.message());
  const fs::path log = out / "run.txt";
  fs::remove(log, failure);
  const auto exit_code = procman::run_program(words, log);
  if (!exit_code) return tl::make_unexpected(exit_code.error());
  if (*exit_code != 0) return base::fail("egraph-run has failed on " + found.folder.string() + ": see " + log.string());
  return {};
}

}  // namespace

base::Result<std::vector<FoundSequence>> find_sequences(const fs::path& root) {
  std::error_code failure;
  std::vector<FoundSequence> found;
  if (const auto* sequence = sequence_in(root)) found.push_back({sequence, root});
  fs::recursive_directory_iterator it(root, fs::directory_options::skip_permission_denied, failure);
  for (const fs::recursive_directory_iterator end; !failure && it != end; it.increment(failure)) {
    if (!it->is_directory(failure)) continue;
    if (const auto* sequence = sequence_in(it->path())) found.push_back({sequence, it->path()});
    const bool is_images = it->path().filename() == "rgb" || it->path().filename() == "depth";
    if (is_images || it.depth() >= kMaxSearchDepth) it.disable_recursion_pending();
  }
  if (failure) return base::fail(root.string() + ": cannot be searched: " + failure.message());
  if (found.empty()) return base::fail(root.string() + ": holds no sequence of the paper's tables (docs/datasets.md)");
  std::sort(found.begin(), found.end(), [](const FoundSequence& a, const FoundSequence& b) {
    return a.sequence != b.sequence ? a.sequence < b.sequence : a.folder < b.folder;
  });
  return found;
}

base::Result<eval::TrajectoryErrors> run_sequence(const FoundSequence& found, const RunPlan& plan) {
  const fs::path out = plan.out / found.folder.lexically_normal().filename();
  // egraph-run removes status.json first and writes it last.
  if (!plan.keep || !holds(out, "status.json")) {
    if (const auto run = run_egraph(found, plan, out); !run) return tl::make_unexpected(run.error());
  }
  const auto ground_truth = ground_truth_of(found, out);
  if (!ground_truth) return tl::make_unexpected(ground_truth.error());
  const auto estimate = io::read_trajectory(out / "trajectory.txt");
  if (!estimate) return tl::make_unexpected(estimate.error());
  const auto reference = io::read_trajectory(*ground_truth);
  if (!reference) return tl::make_unexpected(reference.error());
  return eval::evaluate_trajectory(*estimate, *reference);
}

}  // namespace eg::service
