#pragma once

#include <filesystem>

#include "services/eval/commands.hpp"

namespace eg::service {

/// What a report is made of.
struct ReportFiles {
  std::filesystem::path folder;       ///< of a run; files that are not in it are left out
  std::filesystem::path groundtruth;  ///< empty: none
  std::filesystem::path config;       ///< empty: the defaults
};

/// Writes report.html and the pictures in it (report_mesh_*.png) into the folder. `y_up`: the camera has a negative fy.
base::Result<Report> report_run(const ReportFiles& files, bool y_up);

}  // namespace eg::service
