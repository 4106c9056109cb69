#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "common/base/result.hpp"
#include "common/features/feature_extractor.hpp"

namespace eg::features_eval {

struct SequenceEvaluationOptions {
  std::filesystem::path folder;  ///< a recording with ground truth
  std::string camera;            ///< name or YAML file
  int max_frames = 0;            ///< 0: all
  std::size_t threads = 0;       ///< that one frame's features may take; 0: as many as there are cores
  features::FeatureExtractorOptions extractor;
};

/// Extracts the features of a recording and prints how well the directions of two frames agree under the true rotation
/// between them, one and five seconds apart, how many are seen again in the next frame, and the time taken. The truth
/// of a single direction is not known: errors are differences between two measurements, with the covariance of both.
base::Status evaluate_sequence(const SequenceEvaluationOptions& options, std::ostream& out);

}  // namespace eg::features_eval
