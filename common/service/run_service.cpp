#include <spdlog/spdlog.h>

#include <cstdio>
#include <exception>

#include "common/service/command_line.hpp"
#include "common/service/configuration.hpp"
#include "common/service/logging.hpp"
#include "common/service/service.hpp"
#include "common/service/service_group.hpp"
#include "common/service/stop_signals.hpp"
#include "common/transport/lcm_bus.hpp"

namespace eg::service {
namespace {

constexpr std::chrono::milliseconds kStep{20};

int report(const std::string& message) {
  spdlog::error(message);
  return 1;
}

/// Runs until the end is asked for, or something goes wrong. In any case the results are saved.
int run_group(ServiceGroup& group) {
  int exit_code = 0;
  try {
    while (!stop_requested() && !group.ended()) {
      const base::Status step = group.step(kStep);
      if (!step && !stop_requested()) {
        exit_code = report(step.error().message);
        break;
      }
    }
  } catch (const std::exception& exception) {
    exit_code = report(exception.what());
  }
  const base::Status saved = group.save();
  group.say_goodbye();
  return saved ? exit_code : report(saved.error().message);
}

int run(const ServiceProgram& program, const ServiceOptions& options) {
  auto bus = transport::LcmBus::create({options.lcm_url, options.channel_prefix});
  if (!bus) return report(bus.error().message);
  const auto group = ServiceGroup::make(**bus, program, options);
  return group ? run_group(**group) : report(group.error().message);
}

}  // namespace

int run_service(const ServiceProgram& program, int argc, const char* const* argv) {
  log_to_stderr(program.name);
  const auto parsed = parse_command_line(program, argc, argv);
  if (const int* exit_code = std::get_if<int>(&parsed)) return *exit_code;
  const CommandLine& line = std::get<CommandLine>(parsed);
  catch_stop_signals();
  try {
    const Configuration configuration(program);
    if (const base::Status read = configuration.read(line.options.config_file); !read) {
      return report(read.error().message);
    }
    if (line.print_config) {
      std::fputs(configuration.print().c_str(), stdout);
      return 0;
    }
    return run(program, line.options);
  } catch (const std::exception& exception) {
    return report(exception.what());
  }
}

}  // namespace eg::service
