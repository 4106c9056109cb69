#include "services/features_eval/synthetic_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <ostream>

#include "common/eval/statistics.hpp"
#include "common/geometry/so3.hpp"
#include "common/image/rectifier.hpp"
#include "common/synthetic/sequence.hpp"
#include "services/features_eval/direction_scores.hpp"
#include "services/features_eval/frame_truth.hpp"

namespace eg::features_eval {
namespace {

using features::DirectionFeature;
using features::DirectionKind;
using features::FrameFeatures;

constexpr double kLargePlane = 0.05;  // of the image
constexpr double kMajority = 0.5;     // of pixels
constexpr double kSameAngle = 1.0 * std::numbers::pi / 180.0;
constexpr double kSameDistance = 0.01;  // metres
constexpr double kNearest = 1.0;        // metres: the range in which plane normals are judged
constexpr double kFarthest = 4.0;
constexpr double kFalseAngle = 2.0 * std::numbers::pi / 180.0;  // from every true direction

struct SyntheticScores {
  DirectionErrors normals;
  std::vector<double> distances_m;
  Share large_planes;
  int false_planes = 0;  // most of their pixels do not show one plane
  DirectionErrors vanishing;
  Share groups;
  int false_directions = 0;
  DirectionErrors potential;
  int false_potential = 0;
};

/// How many pixels of every found plane (row) show every true plane (column).
cv::Mat1i overlaps(const cv::Mat& labels, const FrameTruth& truth, std::size_t found) {
  cv::Mat1i counts(static_cast<int>(found), static_cast<int>(truth.planes.size()), 0);
  for (int v = 0; v < labels.rows; ++v) {
    const auto* label = labels.ptr<std::uint8_t>(v);
    const auto* plane = truth.plane_of_pixel.ptr<std::int16_t>(v);
    for (int u = 0; u < labels.cols; ++u) {
      if (label[u] > 0 && plane[u] >= 0) ++counts(label[u] - 1, plane[u]);
    }
  }
  return counts;
}

/// Whether a found plane passes for a true one: a door 4 mm behind its wall may be found as a part of it.
bool agree(const geometry::Plane& found, const geometry::Plane& expected) {
  return geometry::axial_angle(found.normal, expected.normal) < kSameAngle &&
         std::abs(found.distance - expected.distance) < kSameDistance;
}

void judge_planes(const FrameFeatures& features, const cv::Mat& labels, const FrameTruth& truth,
                  SyntheticScores& scores) {
  if (truth.planes.empty()) return;
  const cv::Mat1i counts = overlaps(labels, truth, features.planes.size());
  std::vector<int> covered(truth.planes.size(), 0);
  for (std::size_t i = 0; i < features.planes.size(); ++i) {
    const features::PlaneFeature& plane = features.planes[i];
    const int* row = counts[static_cast<int>(i)];
    const auto best = static_cast<std::size_t>(std::max_element(row, row + counts.cols) - row);
    if (row[best] <= kMajority * plane.support) {
      ++scores.false_planes;
      continue;
    }
    const geometry::Plane& expected = truth.planes[best];
    for (std::size_t k = 0; k < covered.size(); ++k) {
      if (agree(plane.plane, truth.planes[k])) covered[k] = std::max(covered[k], row[k]);
    }
    const bool judged = plane.centroid.z() >= kNearest && plane.centroid.z() <= kFarthest &&
                        plane.support >= kLargePlane * static_cast<double>(labels.total());
    if (!judged) continue;
    scores.normals.add(plane.plane.normal, expected.normal, plane.covariance.topLeftCorner<3, 3>());
    scores.distances_m.push_back(std::abs(plane.plane.distance - expected.distance));
  }
  for (std::size_t i = 0; i < truth.planes.size(); ++i) {
    if (truth.plane_pixels[i] < kLargePlane * static_cast<double>(labels.total())) continue;
    scores.large_planes.add(covered[i] > kMajority * truth.plane_pixels[i]);
  }
}

const Eigen::Vector3d* nearest(const std::vector<Eigen::Vector3d>& directions, const Eigen::Vector3d& to) {
  const auto it = std::min_element(directions.begin(), directions.end(), [&](const auto& a, const auto& b) {
    return geometry::axial_angle(a, to) < geometry::axial_angle(b, to);
  });
  return it == directions.end() || geometry::axial_angle(*it, to) > kFalseAngle ? nullptr : &*it;
}

void judge_directions(const FrameFeatures& features, const FrameTruth& truth, SyntheticScores& scores) {
  std::vector<Eigen::Vector3d> found;
  for (const DirectionFeature& direction : features.directions) {
    if (direction.kind == DirectionKind::plane_normal) continue;
    const bool vanishing = direction.kind == DirectionKind::vanishing_direction;
    if (vanishing) found.push_back(direction.direction);
    if (const auto* expected = nearest(truth.directions, direction.direction)) {
      (vanishing ? scores.vanishing : scores.potential).add(direction.direction, *expected, direction.covariance);
    } else {
      ++(vanishing ? scores.false_directions : scores.false_potential);
    }
  }
  for (const Eigen::Vector3d& group : truth.parallel_groups) scores.groups.add(nearest(found, group) != nullptr);
}

void print(const SyntheticEvaluationOptions& options, const SyntheticScores& scores, std::ostream& out) {
  const eval::ErrorStatistics distance = eval::statistics_of(scores.distances_m);
  out << options.scene << (options.noise ? ", noise" : ", exact") << ", " << options.frames << " frames\n"
      << "  plane normals      " << summary(scores.normals) << '\n'
      << "  plane distances    median " << 1e3 * distance.median << " mm, p95 " << 1e3 * distance.p95 << " mm\n"
      << "  planes over 5 %    found " << summary(scores.large_planes) << "; false planes per frame "
      << static_cast<double>(scores.false_planes) / options.frames << '\n'
      << "  vanishing          " << summary(scores.vanishing) << '\n'
      << "  parallel groups    found " << summary(scores.groups) << "; false directions per frame "
      << static_cast<double>(scores.false_directions) / options.frames << '\n'
      << "  potential          " << summary(scores.potential) << "; false per frame "
      << static_cast<double>(scores.false_potential) / options.frames << '\n';
}

}  // namespace

base::Status evaluate_synthetic(const SyntheticEvaluationOptions& options, std::ostream& out) {
  synthetic::SequenceOptions sequence_options;
  sequence_options.scene = options.scene;
  if (options.noise) sequence_options.noise = synthetic::NoiseOptions{};
  const auto sequence = synthetic::SyntheticSequence::make(sequence_options);
  if (!sequence) return base::fail(sequence.error().message);
  const synthetic::SceneStructure structure = synthetic::structure_of(sequence->scene());

  features::FeatureExtractor extractor(options.extractor);
  image::Rectifier rectifier;
  SyntheticScores scores;
  for (int i = 0; i < options.frames; ++i) {
    const int index = static_cast<int>(static_cast<std::int64_t>(i) * sequence->size() / options.frames);
    const image::RectifiedFrame frame = rectifier.rectify(sequence->frame(index));
    const FrameTruth truth = frame_truth(*sequence, structure, index, frame.depth);
    const FrameFeatures features = extractor.extract(frame);
    judge_planes(features, extractor.plane_labels(), truth, scores);
    judge_directions(features, truth, scores);
  }
  print(options, scores, out);
  return {};
}

}  // namespace eg::features_eval
