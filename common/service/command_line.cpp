#include "common/service/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "common/transport/lcm_bus.hpp"

namespace eg::service {

std::string executable_name(const std::string& service_name) {
  std::string name = service_name;
  std::replace(name.begin(), name.end(), '_', '-');
  return name.starts_with("egraph-") ? name : "egraph-" + name;
}

std::variant<CommandLine, int> parse_command_line(const ServiceProgram& program, int argc, const char* const* argv) {
  CommandLine line;
  ServiceOptions& options = line.options;
  options.name = program.name;
  options.lcm_url = transport::kDefaultLcmUrl;

  CLI::App app(program.description, executable_name(program.name));
  app.option_defaults()->take_last();
  app.add_option("--lcm-url", options.lcm_url, "LCM provider to talk on")
      ->envname("EGRAPH_LCM_URL")
      ->capture_default_str();
  app.add_option("--channel-prefix", options.channel_prefix, "Put before every channel name")
      ->envname("EGRAPH_CHANNEL_PREFIX");
  app.add_option("--config", options.config_file, "YAML configuration; an unknown key is an error")
      ->envname("EGRAPH_CONFIG");
  app.add_option("--out", options.out, "Folder to save results in; without it nothing is saved")->envname("EGRAPH_OUT");
  app.add_flag("--lockstep", options.lockstep, "Every frame is processed, and the result is the same in every run")
      ->envname("EGRAPH_LOCKSTEP");
  app.add_flag("--print-config", line.print_config, "Print the configuration in force and end");
  if (program.add_options) program.add_options(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  return line;
}

}  // namespace eg::service
