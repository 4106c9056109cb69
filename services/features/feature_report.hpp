#pragma once

#include <iosfwd>

#include "common/features/feature_extractor.hpp"
#include "common/image/rgbd_frame.hpp"

namespace eg::features_tool {

/// Mean time of each part of the extraction and of the whole, over `repeats` runs, as a table.
void print_timings(std::ostream& out, const image::RectifiedFrame& frame,
                   const features::FeatureExtractorOptions& options, int repeats);

/// What was found: counts, and every direction with its kind, standard deviation and support.
void print_features(std::ostream& out, const features::FrameFeatures& features);

}  // namespace eg::features_tool
