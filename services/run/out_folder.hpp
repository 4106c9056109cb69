#pragma once

#include <filesystem>

#include "common/base/result.hpp"

namespace eg::run {

/// Makes the folder for results, removes what an earlier run left in it (known result files only), and checks that it
/// can be written to. Returns its absolute path.
base::Result<std::filesystem::path> prepare_out_folder(const std::filesystem::path& folder);

}  // namespace eg::run
