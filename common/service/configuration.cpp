#include "common/service/configuration.hpp"

#include <array>
#include <string>

namespace eg::service {
namespace {

/// Sections that a shared configuration file may have.
constexpr std::array kServiceNames = {"frame_source", "feature_extractor", "egraph_server", "tracker", "mapper",
                                      "viewer"};

}  // namespace

Configuration::Configuration(const ServiceProgram& program) {
  io::ConfigSchema& section = schema_.section(program.name, program.description);
  if (program.configure) program.configure(section);
  for (const std::string name : kServiceNames) {
    if (name != program.name) schema_.foreign(name);
  }
}

base::Status Configuration::read(const std::filesystem::path& file) const {
  if (file.empty()) return {};
  return io::read_config(file, schema_);
}

std::string Configuration::print() const { return io::print_config(schema_); }

}  // namespace eg::service
