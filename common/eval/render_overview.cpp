#include <opencv2/core.hpp>

#include "common/eval/alignment.hpp"
#include "common/eval/render.hpp"
#include "common/eval/trajectory_errors.hpp"

namespace eg::eval {
namespace {

const cv::Scalar kEstimateColour(200, 60, 20);
const cv::Scalar kReferenceColour(40, 40, 220);

Path path_of(const char* label, std::span<const geometry::StampedPose> trajectory, const geometry::Pose& motion,
             const cv::Scalar& colour) {
  Path path{label, {}, colour};
  for (const auto& [time_s, pose] : trajectory) path.points.push_back(motion * pose.translation);
  return path;
}

/// The reference first, so that the estimate is drawn over it.
std::vector<Path> paths_of(const Overview& overview) {
  std::vector<Path> paths;
  const auto pairs =
      match_by_time(overview.estimate, overview.reference, TrajectoryErrorOptions{}.max_time_difference_s);
  if (!pairs.empty()) {
    const geometry::Pose estimate_from_reference = align_positions(pairs).inverse();
    paths.push_back(path_of("ground truth", overview.reference, estimate_from_reference, kReferenceColour));
  }
  if (!overview.estimate.empty()) {
    paths.push_back(path_of("estimated trajectory", overview.estimate, {}, kEstimateColour));
  }
  return paths;
}

}  // namespace

cv::Mat render_overview(const Overview& overview, RenderOptions options) {
  options.up = refine_up(overview.surface, options.up);
  options.azimuth = best_azimuth(overview.surface, options);
  const std::vector<Path> paths = paths_of(overview);
  const cv::Mat plots = plot_paths(paths, options, options.width, options.height / 3);
  if (overview.surface.shape.triangles.empty()) return plots;
  cv::Mat image;
  cv::vconcat(render_scene(overview.surface, paths, overview.keyframes, options), plots, image);
  return image;
}

}  // namespace eg::eval
