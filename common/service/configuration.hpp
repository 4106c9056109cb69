#pragma once

#include <filesystem>
#include <string>

#include "common/service/service.hpp"

namespace eg::service {

/// The configuration of one service: its section of a YAML file that all services can share (docs/running.md).
class Configuration {
 public:
  explicit Configuration(const ServiceProgram& program);

  /// Sets the service's variables from its section. An unknown key, there or at the top, is an error with its line.
  [[nodiscard]] base::Status read(const std::filesystem::path& file) const;

  /// What is in force, as a file that read() accepts.
  [[nodiscard]] std::string print() const;

 private:
  io::ConfigSchema schema_;
};

}  // namespace eg::service
