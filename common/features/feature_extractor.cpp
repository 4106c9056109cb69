#include "common/features/feature_extractor.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/base/check.hpp"

namespace eg::features {
namespace {

/// Appends the directions of the lines to those of the planes, and lets the lines point to their new places.
void append_line_directions(std::vector<MeasuredLine>& lines, std::vector<DirectionFeature> line_directions,
                            FrameFeatures& features) {
  const auto offset = static_cast<std::int32_t>(features.directions.size());
  features.directions.insert(features.directions.end(), line_directions.begin(), line_directions.end());
  features.lines.reserve(lines.size());
  for (MeasuredLine& line : lines) {
    if (line.feature.direction >= 0) line.feature.direction += offset;
    features.lines.push_back(std::move(line.feature));
  }
}

}  // namespace

base::Status validate(const FeatureExtractorOptions& options) {
  if (const auto status = validate(options.points); !status) return status;
  if (const auto status = validate(options.lines); !status) return status;
  if (const auto status = validate(options.directions); !status) return status;
  return validate(options.planes);
}

FeatureExtractor::FeatureExtractor(const FeatureExtractorOptions& options)
    : options_(options), line_extractor_(options.lines), plane_extractor_(options.planes) {
  const auto status = validate(options);
  EG_CHECK(status, status.error().message);
}

FrameFeatures FeatureExtractor::extract(const image::RectifiedFrame& frame) {
  EG_CHECK(frame.colour.size() == frame.depth.size(), "colour and depth have one size");
  EG_CHECK(!frame.camera.has_distortion(), "the frame is rectified");
  FrameFeatures features{frame.header, frame.camera, {}, {}, {}, {}};
  if (frame.colour.empty()) return features;
  cv::cvtColor(frame.colour, grey_, cv::COLOR_BGR2GRAY);

  std::vector<MeasuredLine> lines;
  std::vector<DirectionFeature> line_directions;
  double warp = 0.0;
  tbb::parallel_invoke([&] { features.points = extract_points(grey_, frame.depth, options_.points); },
                       [&] {
                         lines = line_extractor_.extract(grey_, frame.depth, frame.camera);
                         line_directions = extract_line_directions(lines, frame.camera, options_.directions);
                       },
                       [&] {
                         PlaneExtraction extraction = plane_extractor_.extract(frame.depth, frame.camera);
                         features.planes = std::move(extraction.planes);
                         plane_labels_ = extraction.labels;
                         warp = extraction.warp;
                       });
  add_warp(warp, options_.directions, line_directions);
  features.directions = plane_directions(features.planes);
  append_line_directions(lines, std::move(line_directions), features);
  return features;
}

}  // namespace eg::features
