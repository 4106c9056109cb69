#pragma once

#include <string_view>

namespace eg::base {

/// Reports a programmer's error on stderr with its place and ends the process. Never used for bad input.
[[noreturn]] void check_failed(std::string_view condition, std::string_view message, const char* file, int line);

}  // namespace eg::base

/// An invariant that is always checked, in release builds too.
#define EG_CHECK(condition, message) \
  ((condition) ? static_cast<void>(0) : ::eg::base::check_failed(#condition, message, __FILE__, __LINE__))
