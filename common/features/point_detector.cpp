#include "common/features/point_detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>

namespace eg::features {
namespace {

constexpr int kPatchRadius = 15;           // of ORB's orientation and descriptor patch
constexpr int kBorder = kPatchRadius + 4;  // the patch, rotated and smoothed, stays inside the image

/// Half the width of every row of a disc of radius kPatchRadius.
std::array<int, kPatchRadius + 1> disc_half_widths() {
  std::array<int, kPatchRadius + 1> widths{};
  for (int v = 0; v <= kPatchRadius; ++v) {
    widths[static_cast<std::size_t>(v)] = static_cast<int>(std::sqrt(kPatchRadius * kPatchRadius - v * v));
  }
  return widths;
}

/// Degrees, in [0, 360): direction from the corner to the intensity centroid of the disc around it.
float orientation(const cv::Mat& grey, const cv::Point2f& corner) {
  static const auto widths = disc_half_widths();
  const int x = cvRound(corner.x);
  const int y = cvRound(corner.y);
  int moment_x = 0;
  int moment_y = 0;
  for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
    const auto* row = grey.ptr<std::uint8_t>(y + v) + x;
    const int width = widths[static_cast<std::size_t>(std::abs(v))];
    int row_sum = 0;
    for (int u = -width; u <= width; ++u) {
      row_sum += row[u];
      moment_x += u * row[u];
    }
    moment_y += v * row_sum;
  }
  return cv::fastAtan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

/// The order in which corners are kept: rank within the cell, then strength, then position (so that it is total).
struct Candidate {
  cv::KeyPoint corner;
  int cell = 0;
  int rank = 0;

  [[nodiscard]] auto key() const { return std::tuple(rank, -corner.response, corner.pt.y, corner.pt.x); }
};

void rank_within_cells(std::vector<Candidate>& candidates) {
  const auto by_cell = [](const Candidate& a, const Candidate& b) {
    return std::tuple(a.cell, -a.corner.response, a.corner.pt.y, a.corner.pt.x) <
           std::tuple(b.cell, -b.corner.response, b.corner.pt.y, b.corner.pt.x);
  };
  std::sort(candidates.begin(), candidates.end(), by_cell);
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    if (candidates[i].cell == candidates[i - 1].cell) candidates[i].rank = candidates[i - 1].rank + 1;
  }
}

std::vector<cv::KeyPoint> corners_of_level(const cv::Mat& level, int max_corners, const PointDetectorOptions& options) {
  const cv::Rect inside(kBorder, kBorder, level.cols - 2 * kBorder, level.rows - 2 * kBorder);
  constexpr int kFastRadius = 3;  // FAST looks that far around a corner
  const cv::Rect searched(inside.x - kFastRadius, inside.y - kFastRadius, inside.width + 2 * kFastRadius,
                          inside.height + 2 * kFastRadius);
  std::vector<cv::KeyPoint> corners;
  cv::FAST(level(searched), corners, options.fast_threshold, true);

  const int cells_per_row = inside.width / options.cell_size + 1;
  std::vector<Candidate> candidates;
  candidates.reserve(corners.size());
  for (cv::KeyPoint& corner : corners) {
    const int cell = static_cast<int>(corner.pt.y) / options.cell_size * cells_per_row +
                     static_cast<int>(corner.pt.x) / options.cell_size;
    corner.pt += cv::Point2f(searched.tl());
    candidates.push_back({corner, cell, 0});
  }
  rank_within_cells(candidates);
  const auto kept = std::min(candidates.size(), static_cast<std::size_t>(max_corners));
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(kept), candidates.end(),
                    [](const Candidate& a, const Candidate& b) { return a.key() < b.key(); });

  corners.clear();
  for (std::size_t i = 0; i < kept; ++i) corners.push_back(candidates[i].corner);
  return corners;
}

/// Moves corners to the point that the gradients around them are perpendicular to the ray from. FAST has whole pixels
/// of the level, and its corner lies beside the edges that meet.
void refine(const cv::Mat& level, std::vector<cv::KeyPoint>& corners) {
  if (corners.empty()) return;
  constexpr float kLargestMove = 1.5F;  // pixels: farther may be another corner
  constexpr int kReach = 3;             // pixels on each side
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 5, 0.05);
  std::vector<cv::Point2f> refined;
  cv::KeyPoint::convert(corners, refined);
  cv::cornerSubPix(level, refined, {kReach, kReach}, {-1, -1}, enough);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (cv::norm(refined[i] - corners[i].pt) < kLargestMove) corners[i].pt = refined[i];
  }
}

/// How many of `max_points` belong to each level: in proportion to its area, or what is left over from finer levels.
int share_of_level(int level, int left_over, const PointDetectorOptions& options) {
  const double ratio = 1.0 / (options.scale_factor * options.scale_factor);
  double rest = 0.0;
  for (int i = level; i < options.levels; ++i) rest += std::pow(ratio, i - level);
  return static_cast<int>(std::ceil(left_over / rest));
}

}  // namespace

std::vector<cv::KeyPoint> detect_corners(const cv::Mat& grey, const PointDetectorOptions& options) {
  std::vector<cv::KeyPoint> all;
  cv::Mat level = grey;
  for (int octave = 0; octave < options.levels; ++octave) {
    const double scale = std::pow(options.scale_factor, octave);
    if (octave > 0) {
      cv::Mat smaller;
      cv::resize(level, smaller, {cvRound(grey.cols / scale), cvRound(grey.rows / scale)}, 0, 0, cv::INTER_LINEAR);
      level = smaller;
    }
    if (std::min(level.cols, level.rows) <= 2 * kBorder) break;

    const int left_over = options.max_points - static_cast<int>(all.size());
    std::vector<cv::KeyPoint> found = corners_of_level(level, share_of_level(octave, left_over, options), options);
    refine(level, found);
    for (cv::KeyPoint& corner : found) {
      corner.octave = octave;
      corner.angle = orientation(level, corner.pt);
      corner.size = static_cast<float>((2 * kPatchRadius + 1) * scale);
      all.push_back(corner);
    }
  }
  return all;
}

}  // namespace eg::features
