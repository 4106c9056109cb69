#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.hpp"

namespace eg::procman {

/// Runs a program to its end in this process's own group (Ctrl-C reaches both); both of its outputs are appended to
/// `log`. `words`: the executable's path and its arguments. Returns its exit code as a shell has it (128 + N after
/// signal N), or why it could not be started.
base::Result<int> run_program(const std::vector<std::string>& words, const std::filesystem::path& log);

}  // namespace eg::procman
