#include "services/features/feature_report.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iomanip>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <ostream>
#include <vector>

namespace eg::features_tool {
namespace {

using Clock = std::chrono::steady_clock;

void print_mean_time(std::ostream& out, const char* part, int repeats, const std::function<void()>& run) {
  run();  // warms caches and buffers
  const auto start = Clock::now();
  for (int i = 0; i < repeats; ++i) run();
  const double total_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  out << "  " << std::left << std::setw(12) << part << std::right << std::setw(8) << total_ms / repeats << " ms\n";
}

const char* name_of(features::DirectionKind kind) {
  switch (kind) {
    case features::DirectionKind::plane_normal:
      return "plane normal";
    case features::DirectionKind::vanishing_direction:
      return "vanishing";
    case features::DirectionKind::potential_direction:
      return "potential";
  }
  return "unknown";
}

double max_sigma_degrees(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[2])) * 180.0 / std::numbers::pi;
}

}  // namespace

void print_timings(std::ostream& out, const image::RectifiedFrame& frame,
                   const features::FeatureExtractorOptions& options, int repeats) {
  cv::Mat grey;
  cv::cvtColor(frame.colour, grey, cv::COLOR_BGR2GRAY);
  features::LineExtractor line_extractor(options.lines);
  std::vector<features::MeasuredLine> lines = line_extractor.extract(grey, frame.depth, frame.camera);
  features::PlaneExtractor planes(options.planes);
  features::FeatureExtractor all(options);
  out << std::fixed << std::setprecision(2) << "mean time of " << repeats << " runs\n";
  print_mean_time(out, "points", repeats, [&] { (void)features::extract_points(grey, frame.depth, options.points); });
  print_mean_time(out, "lines", repeats, [&] { lines = line_extractor.extract(grey, frame.depth, frame.camera); });
  print_mean_time(out, "directions", repeats,
                  [&] { (void)features::extract_line_directions(lines, frame.camera, options.directions); });
  print_mean_time(out, "planes", repeats, [&] { (void)planes.extract(frame.depth, frame.camera); });
  print_mean_time(out, "all, threads", repeats, [&] { (void)all.extract(frame); });
}

void print_features(std::ostream& out, const features::FrameFeatures& features) {
  const auto points_in_space = std::count_if(features.points.begin(), features.points.end(),
                                             [](const features::PointFeature& point) { return point.has_depth(); });
  const auto lines_in_space = std::count_if(features.lines.begin(), features.lines.end(),
                                            [](const features::LineFeature& line) { return line.has_depth; });
  out << features.points.size() << " points (" << points_in_space << " with depth), " << features.lines.size()
      << " lines (" << lines_in_space << " with depth), " << features.planes.size() << " planes, "
      << features.directions.size() << " directions:\n";
  out << std::fixed << std::setprecision(4);
  for (const features::DirectionFeature& direction : features.directions) {
    const Eigen::Vector3d& d = direction.direction;
    out << "  " << std::left << std::setw(14) << name_of(direction.kind) << std::right << std::setw(9) << d.x()
        << std::setw(9) << d.y() << std::setw(9) << d.z() << "  sigma " << max_sigma_degrees(direction.covariance)
        << " deg, support " << direction.support << '\n';
  }
}

}  // namespace eg::features_tool
