#pragma once

#include <iosfwd>
#include <string>

#include "common/base/result.hpp"
#include "common/features/feature_extractor.hpp"

namespace eg::features_eval {

struct SyntheticEvaluationOptions {
  std::string scene = "room";
  bool noise = true;  ///< the depth and colour noise of a structured-light camera; else exact images
  int frames = 60;    ///< spread over the scene's trajectory
  features::FeatureExtractorOptions extractor;
};

/// Extracts the features of frames of a built-in scene and prints their errors against the exact truth: angle errors
/// and consistency of plane normals and vanishing directions, recall of planes over 5 % of the image and of groups of
/// parallel edges, planes and directions that are not there. Fails on an unknown scene.
base::Status evaluate_synthetic(const SyntheticEvaluationOptions& options, std::ostream& out);

}  // namespace eg::features_eval
