#include <memory>

#include "common/service/service.hpp"
#include "services/mapper/mapper_config.hpp"
#include "services/mapper/mapper_service.hpp"

int main(int argc, char** argv) {
  eg::services::MapperOptions options;
  eg::service::ServiceProgram program;
  program.name = "mapper";
  program.description = "Fuses the depth images of keyframes into a coloured mesh";
  program.configure = [&](eg::io::ConfigSchema& section) { eg::services::describe_options(section, options); };
  program.make = [&](eg::service::ServiceContext& context) -> eg::base::Result<std::unique_ptr<eg::service::Service>> {
    if (const auto status = eg::mapping::validate(options.tsdf); !status) return eg::base::fail(status.error().message);
    return std::make_unique<eg::services::MapperService>(context, options);
  };
  return eg::service::run_service(program, argc, argv);
}
