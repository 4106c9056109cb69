#include "services/feature_extractor/feature_extractor_config.hpp"

namespace eg::feature_extractor {
namespace {

void describe_points(io::ConfigSchema& section, features::PointExtractorOptions& points) {
  section.field("max_points", points.detector.max_points, {0, features::kMaxPoints}, "ORB points kept per frame");
  section.field("levels", points.detector.levels, {1, 16}, "of the image pyramid");
  section.field("scale_factor", points.detector.scale_factor, {1.01, 2.0}, "between levels");
  section.field("fast_threshold", points.detector.fast_threshold, {1, 255}, "grey levels of the weakest corner");
  section.field("cell_size", points.detector.cell_size, {8, 1000}, "pixels, of the grid that spreads the points");
  section.field("pixel_sigma", points.pixel_sigma, {0.01, 100.0}, "pixels, of a point on the finest level");
}

void describe_lines(io::ConfigSchema& section, features::LineExtractorOptions& lines) {
  section.choice<features::LineDetectorKind>(
      "detector", lines.detector.kind,
      {{"lsd", features::LineDetectorKind::lsd}, {"edlines", features::LineDetectorKind::edlines}}, "lsd or edlines");
  section.field("min_length", lines.detector.min_length, {0.005, 0.99}, "of a segment, as a share of the diagonal");
  section.field("max_lines", lines.max_lines, {0, features::kMaxLines}, "the longest are kept");
  section.field("merge_gap", lines.merger.max_gap, {0, 1000}, "pixels between two pieces of one line");
  section.field("min_inliers", lines.lifter.min_inliers, {3, 1000}, "depth readings on a line in space");
  section.field("min_inlier_ratio", lines.lifter.min_inlier_ratio, {0.01, 1.0}, "of all readings along the segment");
}

void describe_directions(io::ConfigSchema& section, features::DirectionExtractorOptions& directions) {
  section.field("hypotheses", directions.hypotheses, {1, features::kMaxHypotheses}, "of J-Linkage");
  section.field("max_linkage_error", directions.max_linkage_error, {0.1, 100.0}, "pixels from a vanishing point");
  section.field("min_depth_lines", directions.group.min_depth_lines, {2, 1000}, "that make a vanishing direction");
  section.field("min_image_lines", directions.group.min_image_lines, {3, 1000}, "that do so where depth is missing");
  section.field("sigma_floor", directions.sigma_floor, {0.0, 1.0}, "radians, added to every direction");
  section.field("warp_sigma", directions.warp_sigma, {0.0, 1.0}, "radians, added times the warp of the depth");
  section.field("max_potential", directions.max_potential, {0, 400}, "potential directions per frame");
}

void describe_planes(io::ConfigSchema& section, features::PlaneOptions& planes) {
  section.field("block_size", planes.block_size, {0, 1000}, "pixels; 0: by the image's size");
  section.field("min_support", planes.min_support_fraction, {0.0001, 1.0}, "of a plane, as a share of the image");
}

}  // namespace

void describe_options(io::ConfigSchema& section, features::FeatureExtractorOptions& options) {
  describe_points(section.section("points", "ORB points"), options.points);
  describe_lines(section.section("lines", "line segments"), options.lines);
  describe_directions(section.section("directions", "vanishing and potential directions"), options.directions);
  describe_planes(section.section("planes", "planes of the depth image"), options.planes);
}

}  // namespace eg::feature_extractor
