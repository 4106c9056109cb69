#pragma once

#include <variant>

#include "common/service/service.hpp"

namespace eg::service {

struct CommandLine {
  ServiceOptions options;
  bool print_config = false;
};

/// The options every service has, from the command line and else from the environment, and those of the program. An int
/// is the exit code of a process that has no more to do: --help was answered (0), or the mistake was reported on
/// stderr.
std::variant<CommandLine, int> parse_command_line(const ServiceProgram& program, int argc, const char* const* argv);

/// "egraph_server" → "egraph-server", "tracker" → "egraph-tracker".
std::string executable_name(const std::string& service_name);

}  // namespace eg::service
