#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace eg::doctor {

enum class Severity : std::uint8_t {
  good = 0,
  warning = 1,  ///< works, but not well or not always
  error = 2,    ///< does not work
};

/// What one check found.
struct Finding {
  Severity severity = Severity::good;
  std::string what;  ///< one sentence
  std::string mend;  ///< what to type or do about it; empty if all is well
};

using Findings = std::vector<Finding>;

}  // namespace eg::doctor
