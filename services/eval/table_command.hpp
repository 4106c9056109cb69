#pragma once

#include <filesystem>

#include "common/base/result.hpp"
#include "services/eval/sequence_runs.hpp"

namespace eg::service {

/// Runs every known sequence under `root` and prints, as it goes, one line each, then the published tables with our
/// column beside the published ones. Writes table.txt, table.csv and table.png into plan.out. An error if a sequence
/// has failed, when all that is done.
base::Status print_table(const std::filesystem::path& root, const RunPlan& plan);

/// Runs every known sequence under `root` once with the defaults and once with each configuration (*.yaml) in
/// `configs`: what each part is worth. Prints ATE and ARE with a column per configuration, and writes ablation.txt,
/// .csv and .png into plan.out.
base::Status print_ablation(const std::filesystem::path& root, const std::filesystem::path& configs,
                            const RunPlan& plan);

}  // namespace eg::service
