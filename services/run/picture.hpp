#pragma once

#include <filesystem>

#include "common/base/result.hpp"
#include "services/run/input.hpp"

namespace eg::run {

/// Draws what is in `out` (mesh, trajectory, keyframes; each may be missing) and the ground truth into out/picture.png
/// with `egraph_eval` (the program), whose output goes to out/log.txt.
base::Status draw_picture(const std::filesystem::path& egraph_eval, const std::filesystem::path& out,
                          const Input& input);

/// Describes the run in out/report.html, with every setting that was in force, which out/settings.yaml then holds too.
/// `programs`: the folder of egraph-eval and the services.
base::Status write_report_page(const std::filesystem::path& programs, const std::filesystem::path& out,
                               const Input& input);

}  // namespace eg::run
