#include "common/service/configuration.hpp"

namespace eg::service {

Configuration::Configuration(const ServiceProgram& program) {
  io::ConfigSchema& section = schema_.section(program.name, program.description);
  if (program.configure) program.configure(section);
}

base::Status Configuration::read(const std::filesystem::path& file) const {
  if (file.empty()) return {};
  return io::read_config(file, schema_);
}

std::string Configuration::print() const { return io::print_config(schema_); }

}  // namespace eg::service
