#pragma once

#include "common/io/config.hpp"
#include "services/mapper/mapper_options.hpp"

namespace eg::services {

/// The keys of the service's section in a configuration file. `options` must outlive `section`.
void describe_options(io::ConfigSchema& section, MapperOptions& options);

}  // namespace eg::services
