#pragma once

#include <string>

namespace eg::service {

/// Sends spdlog's default logger to stderr, a line each: "[tracker] message", "[tracker] warning: message",
/// "[tracker] error: message".
void log_to_stderr(const std::string& name);

}  // namespace eg::service
