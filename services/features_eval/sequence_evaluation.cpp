#include "services/features_eval/sequence_evaluation.hpp"

#include <fmt/core.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numbers>
#include <optional>
#include <ostream>
#include <vector>

#include "common/eval/statistics.hpp"
#include "common/geometry/so3.hpp"
#include "common/image/rectifier.hpp"
#include "common/io/camera_file.hpp"
#include "common/io/dataset.hpp"
#include "common/io/trajectory_file.hpp"
#include "services/features_eval/direction_scores.hpp"

namespace eg::features_eval {
namespace {

using features::DirectionFeature;
using features::DirectionKind;
using features::FrameFeatures;
using geometry::Pose;
using geometry::StampedPose;

constexpr double kSameDirection = 5.0 * std::numbers::pi / 180.0;
constexpr double kSamePlane = 0.05;       // metres ...
constexpr double kSamePlaneShare = 0.02;  // ... and of the distance
constexpr double kLargePlane = 0.05;      // of the image

struct PosedFeatures {
  double time_s = 0.0;
  Pose world_from_camera;
  FrameFeatures features;
};

/// The true pose at a time, interpolated; none outside the trajectory and in gaps.
std::optional<Pose> pose_at(const std::vector<StampedPose>& trajectory, double time_s) {
  constexpr double kLongestGap = 0.1;  // seconds
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), time_s,
                                      [](const StampedPose& pose, double time) { return pose.time_s < time; });
  if (after == trajectory.end()) return std::nullopt;
  if (after == trajectory.begin()) {
    return after->time_s - time_s < 1e-3 ? std::optional(after->world_from_camera) : std::nullopt;
  }
  const StampedPose& before = *(after - 1);
  const double gap = after->time_s - before.time_s;
  if (gap > kLongestGap) return std::nullopt;
  const double share = (time_s - before.time_s) / gap;
  const Pose& a = before.world_from_camera;
  const Pose& b = after->world_from_camera;
  return Pose{a.rotation * geometry::so3_exp(share * geometry::so3_log(a.rotation.transpose() * b.rotation)),
              a.translation + share * (b.translation - a.translation)};
}

/// Whether the planes of two normals, the second in the first frame, are one plane.
bool same_plane(const PosedFeatures& first, const DirectionFeature& a, const PosedFeatures& second,
                const DirectionFeature& b) {
  const auto& plane = first.features.planes[static_cast<std::size_t>(a.source)].plane;
  const auto& other = second.features.planes[static_cast<std::size_t>(b.source)];
  const Eigen::Vector3d point = first.world_from_camera.inverse() * (second.world_from_camera * other.centroid);
  return std::abs(plane.signed_distance(point)) < kSamePlane + kSamePlaneShare * point.norm();
}

/// The direction of `second` nearest to direction `i` of `first` among those of its kind that may be the same.
std::optional<std::size_t> nearest(const PosedFeatures& first, std::size_t i, const PosedFeatures& second) {
  const DirectionFeature& a = first.features.directions[i];
  const Eigen::Matrix3d rotation = first.world_from_camera.rotation.transpose() * second.world_from_camera.rotation;
  std::optional<std::size_t> best;
  double best_angle = kSameDirection;
  for (const std::size_t j : indices_of(second.features.directions, a.kind)) {
    const DirectionFeature& b = second.features.directions[j];
    const double angle = geometry::axial_angle(a.direction, rotation * b.direction);
    if (angle >= best_angle) continue;
    if (a.kind == DirectionKind::plane_normal && !same_plane(first, a, second, b)) continue;
    best = j;
    best_angle = angle;
  }
  return best;
}

/// Adds the errors of the directions that are each other's nearest.
void compare(const PosedFeatures& first, const PosedFeatures& second, DirectionKind kind, DirectionErrors& errors) {
  const Eigen::Matrix3d rotation = first.world_from_camera.rotation.transpose() * second.world_from_camera.rotation;
  for (const std::size_t i : indices_of(first.features.directions, kind)) {
    const auto j = nearest(first, i, second);
    if (!j || nearest(second, *j, first) != i) continue;
    const DirectionFeature& a = first.features.directions[i];
    const DirectionFeature& b = second.features.directions[*j];
    errors.add(a.direction, rotation * b.direction, a.covariance + rotation * b.covariance * rotation.transpose());
  }
}

void print_errors(const std::vector<PosedFeatures>& frames, double seconds, std::ostream& out) {
  constexpr double kTolerance = 0.02;  // seconds
  DirectionErrors planes, vanishing;
  std::size_t j = 0;
  for (const PosedFeatures& first : frames) {
    while (j < frames.size() && frames[j].time_s < first.time_s + seconds - kTolerance) ++j;
    if (j == frames.size()) break;
    if (frames[j].time_s > first.time_s + seconds + kTolerance) continue;
    compare(first, frames[j], DirectionKind::plane_normal, planes);
    compare(first, frames[j], DirectionKind::vanishing_direction, vanishing);
  }
  out << "  " << seconds << " s apart: planes     " << summary(planes) << '\n'
      << "  " << seconds << " s apart: vanishing  " << summary(vanishing) << '\n';
}

void print_repeatability(const std::vector<PosedFeatures>& frames, std::ostream& out) {
  Share planes, large_planes, vanishing, potential;
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    const FrameFeatures& features = frames[i].features;
    const double large = kLargePlane * features.camera.width * features.camera.height;
    for (std::size_t k = 0; k < features.directions.size(); ++k) {
      const DirectionFeature& direction = features.directions[k];
      const bool again = nearest(frames[i], k, frames[i + 1]).has_value();
      if (direction.kind == DirectionKind::vanishing_direction) vanishing.add(again);
      if (direction.kind == DirectionKind::potential_direction) potential.add(again);
      if (direction.kind != DirectionKind::plane_normal) continue;
      planes.add(again);
      if (direction.support >= large) large_planes.add(again);
    }
  }
  out << "  seen again in the next frame: planes " << summary(planes) << ", planes over 5 % of the image "
      << summary(large_planes) << ", vanishing " << summary(vanishing) << ", potential " << summary(potential) << '\n';
}

struct Timing {
  std::vector<double> wall_ms, cpu_ms;
};

void print_timing(const Timing& timing, std::ostream& out) {
  const eval::ErrorStatistics wall = eval::statistics_of(timing.wall_ms);
  const eval::ErrorStatistics cpu = eval::statistics_of(timing.cpu_ms);
  const auto slowest = std::max_element(timing.wall_ms.begin(), timing.wall_ms.end()) - timing.wall_ms.begin();
  const auto over_twice = std::count_if(timing.wall_ms.begin(), timing.wall_ms.end(),
                                        [&](double milliseconds) { return milliseconds > 2.0 * wall.mean; });
  out << fmt::format("  CPU per frame:  median {:.1f} ms, mean {:.1f}, p95 {:.1f}, max {:.1f}\n", cpu.median, cpu.mean,
                     cpu.p95, cpu.max)
      << fmt::format(
             "  wall per frame: median {:.1f} ms, mean {:.1f}, p95 {:.1f}, max {:.1f} (frame {}); {} of {} above twice "
             "the "
             "mean\n",
             wall.median, wall.mean, wall.p95, wall.max, slowest, over_twice, wall.count);
}

/// Runs the extractor and clocks it.
FrameFeatures extract(features::FeatureExtractor& extractor, const image::RectifiedFrame& frame, Timing& timing) {
  const auto wall = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  FrameFeatures features = extractor.extract(frame);
  timing.cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC);
  timing.wall_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - wall).count());
  return features;
}

}  // namespace

base::Status evaluate_sequence(const SequenceEvaluationOptions& options, std::ostream& out) {
  const auto dataset = io::open_dataset(options.folder);
  if (!dataset) return base::fail(dataset.error().message);
  const auto camera = io::read_camera(options.camera);
  if (!camera) return base::fail(camera.error().message);
  if (dataset->ground_truth.empty()) return base::fail(options.folder.string() + ": has no ground truth");
  const auto truth = io::read_trajectory(dataset->ground_truth);
  if (!truth) return base::fail(truth.error().message);

  std::optional<tbb::global_control> limit;
  if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, options.threads);
  features::FeatureExtractor extractor(options.extractor);
  image::Rectifier rectifier;
  Timing timing;
  std::vector<PosedFeatures> frames;
  const std::size_t count = options.max_frames > 0
                                ? std::min(dataset->frames.size(), static_cast<std::size_t>(options.max_frames))
                                : dataset->frames.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = dataset->frames[i].time_s;
    const auto pose = pose_at(*truth, time_s);
    if (!pose) continue;
    const auto frame = io::read_frame(*dataset, i, *camera);
    if (!frame) return base::fail(frame.error().message);
    frames.push_back({time_s, *pose, extract(extractor, rectifier.rectify(*frame), timing)});
    frames.back().features.points.clear();
    frames.back().features.lines.clear();
  }
  out << options.folder.filename().string() << ", " << frames.size() << " frames\n";
  print_errors(frames, 1.0, out);
  print_errors(frames, 5.0, out);
  print_repeatability(frames, out);
  print_timing(timing, out);
  return {};
}

}  // namespace eg::features_eval
