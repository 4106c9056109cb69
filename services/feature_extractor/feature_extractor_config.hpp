#pragma once

#include "common/features/feature_extractor.hpp"
#include "common/io/config.hpp"

namespace eg::feature_extractor {

/// The keys of the service's section in a configuration file. `options` must outlive `section`.
void describe_options(io::ConfigSchema& section, features::FeatureExtractorOptions& options);

}  // namespace eg::feature_extractor
