#pragma once

#include <filesystem>

#include "common/base/result.hpp"
#include "common/procman/file_descriptor.hpp"

namespace eg::run {

/// Every setting of every service, beside a report.
inline constexpr char kSettingsFile[] = "settings.yaml";

/// The folder for a run's results. While this object lives no other run takes it: the services of two would write into
/// each other's journals.
struct OutFolder {
  std::filesystem::path path;    ///< absolute
  procman::FileDescriptor lock;  ///< of the folder itself, so that nothing is left behind in any case
};

/// Makes the folder, checks that it can be written to and that no other run has it, and removes what an earlier run
/// left in it (known result files only).
base::Result<OutFolder> prepare_out_folder(const std::filesystem::path& folder);

}  // namespace eg::run
