#include <memory>

#include "common/service/service.hpp"
#include "services/feature_extractor/feature_extractor_config.hpp"
#include "services/feature_extractor/feature_extractor_service.hpp"

int main(int argc, char** argv) {
  eg::features::FeatureExtractorOptions options;
  eg::service::ServiceProgram program;
  program.name = "feature_extractor";
  program.description = "Extracts points, lines, planes and directions from every colour and depth image";
  program.configure = [&](eg::io::ConfigSchema& section) { eg::feature_extractor::describe_options(section, options); };
  program.make = [&](eg::service::ServiceContext& context) -> eg::base::Result<std::unique_ptr<eg::service::Service>> {
    if (const auto status = eg::features::validate(options); !status) return eg::base::fail(status.error().message);
    return std::make_unique<eg::feature_extractor::FeatureExtractorService>(context, options);
  };
  return eg::service::run_service(program, argc, argv);
}
