#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.hpp"

namespace eg::procman {

/// What the exec attribute of a command means.
struct ExecLine {
  std::vector<std::pair<std::string, std::string>> environment;  ///< from leading NAME=VALUE words
  std::vector<std::string> words;                                ///< program and arguments; at least one
};

/// The value of an environment variable, or nothing if there is no such variable.
using LookUpVariable = std::function<std::optional<std::string>(const std::string& name)>;

/// LookUpVariable on the environment of this process.
std::optional<std::string> look_up_in_environment(const std::string& name);

/// Splits like a shell: blanks separate words, '...' is literal, "..." knows \" \\ \$ and \`, a backslash elsewhere
/// takes the next character as it is. No globs, pipes or comments. Then $NAME and ${NAME} are replaced in every word;
/// names that are not known stay as they are. An error says what is wrong with the quoting, or that there is no
/// program.
base::Result<ExecLine> parse_exec(std::string_view exec, const LookUpVariable& look_up);

}  // namespace eg::procman
