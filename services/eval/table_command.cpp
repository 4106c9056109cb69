#include "services/eval/table_command.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/eval/published.hpp"
#include "common/eval/result_table.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/image_file.hpp"

namespace eg::service {
namespace {

namespace fs = std::filesystem;

constexpr double kFailed = std::numeric_limits<double>::quiet_NaN();

/// Runs a sequence and says how that went.
eval::SequenceResult run_and_tell(const FoundSequence& found, const RunPlan& plan, const std::string& label) {
  eval::SequenceResult result{found.sequence->name, kFailed, kFailed, kFailed};
  const auto errors = run_sequence(found, plan);
  const std::string name = result.sequence + label;
  if (!errors) {
    std::printf("%-30s failed: %s\n", name.c_str(), errors.error().message.c_str());
  } else {
    result.ate_rmse_m = errors->ate_m.rmse;
    result.are_mean_deg = errors->are_aligned_deg.mean;
    result.are_first_pose_deg = errors->are_first_pose_deg.mean;
    std::printf("%-30s ATE %.4f m, ARE %.3f deg, %zu poses, %.1f %% of the time covered, %s\n", name.c_str(),
                result.ate_rmse_m, result.are_mean_deg, errors->matched_poses, 100.0 * errors->coverage,
                found.folder.c_str());
  }
  std::fflush(stdout);
  return result;
}

/// Prints the tables and writes them as NAME.txt, NAME.csv and NAME.png.
base::Status publish(const std::vector<eval::ResultTable>& tables, const fs::path& folder, const std::string& name) {
  std::string text;
  for (const eval::ResultTable& table : tables) text.append(1, '\n').append(to_text(table));
  std::fputs(text.c_str(), stdout);
  if (const auto done = io::write_file_atomically(folder / (name + ".txt"), text); !done) return done;
  if (const auto done = io::write_file_atomically(folder / (name + ".csv"), to_csv(tables)); !done) return done;
  return io::write_png(folder / (name + ".png"), draw_tables(tables));
}

base::Result<std::vector<fs::path>> configurations_in(const fs::path& folder) {
  std::error_code failure;
  std::vector<fs::path> files;
  for (fs::directory_iterator it(folder, failure), end; !failure && it != end; it.increment(failure)) {
    if (it->path().extension() == ".yaml") files.push_back(it->path());
  }
  if (failure) return base::fail(folder.string() + ": cannot be read: " + failure.message());
  if (files.empty()) return base::fail(folder.string() + ": holds no configuration (*.yaml)");
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

base::Status print_table(const fs::path& root, const RunPlan& plan) {
  const auto found = find_sequences(root);
  if (!found) return tl::make_unexpected(found.error());
  std::vector<eval::SequenceResult> results;
  for (const FoundSequence& sequence : *found) results.push_back(run_and_tell(sequence, plan, ""));
  if (auto published = publish(compare_with_published(results), plan.out, "table"); !published) return published;
  const auto failed =
      std::count_if(results.begin(), results.end(), [](const auto& result) { return std::isnan(result.ate_rmse_m); });
  if (failed == 0) return {};
  return base::fail(std::to_string(failed) + " of " + std::to_string(results.size()) +
                    " sequences failed, as said above");
}

base::Status print_ablation(const fs::path& root, const fs::path& configs, const RunPlan& plan) {
  const auto found = find_sequences(root);
  if (!found) return tl::make_unexpected(found.error());
  const auto configurations = configurations_in(configs);
  if (!configurations) return tl::make_unexpected(configurations.error());

  eval::ResultTable ate{"Absolute trajectory error, RMSE (m)", 4, {"all on"}, {}};
  eval::ResultTable are{"Absolute rotation error, mean (degrees)", 3, {"all on"}, {}};
  for (const FoundSequence& sequence : *found) {
    eval::ResultRow ate_row{sequence.sequence->name, {}};
    eval::ResultRow are_row{sequence.sequence->name, {}};
    const auto add = [&](const fs::path& config, const std::string& variant) {
      RunPlan variant_plan = plan;
      variant_plan.config = config;
      variant_plan.out = plan.out / variant;
      const eval::SequenceResult result = run_and_tell(sequence, variant_plan, ", " + variant);
      ate_row.values.emplace_back(result.ate_rmse_m);
      are_row.values.emplace_back(result.are_mean_deg);
    };
    add(plan.config, "all on");
    for (const fs::path& config : *configurations) add(config, config.stem().string());
    ate.rows.push_back(ate_row);
    are.rows.push_back(are_row);
  }
  for (const fs::path& config : *configurations) {
    ate.columns.push_back(config.stem().string());
    are.columns.push_back(config.stem().string());
  }
  return publish({ate, are}, plan.out, "ablation");
}

}  // namespace eg::service
