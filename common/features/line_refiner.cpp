#include "common/features/line_refiner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace eg::features {
namespace {

constexpr int kReach = 3;                // samples on each side of the segment
constexpr double kStationSpacing = 1.5;  // pixels
constexpr int kMaxStations = 64;
constexpr double kMinGradient = 2.0;         // grey levels per pixel of a peak
constexpr double kMinPeakShare = 0.5;        // of the stations
constexpr double kDetectorSigma = 0.6;       // pixels, when the position could not be measured
constexpr double kSigmaFloor = 0.05;         // pixels: lens, sampling and demosaicing leave that much
constexpr double kCorrelatedStations = 1.5;  // stations that share noise (smoothing, compression)

using Profile = std::array<double, 2 * kReach + 1>;

/// Displacement of the edge at one station.
struct Peak {
  double position;  // along the segment, -1 at its start, 1 at its end
  double offset;    // across it, pixels
};

double sample(const cv::Mat& grey, const Eigen::Vector2d& p) {
  const int x = static_cast<int>(p.x());
  const int y = static_cast<int>(p.y());
  const double fx = p.x() - x;
  const double fy = p.y() - y;
  const auto* upper = grey.ptr<std::uint8_t>(y) + x;
  const auto* lower = grey.ptr<std::uint8_t>(y + 1) + x;
  return (1 - fy) * ((1 - fx) * upper[0] + fx * upper[1]) + fy * ((1 - fx) * lower[0] + fx * lower[1]);
}

std::vector<Profile> sample_profiles(const cv::Mat& grey, const Segment& segment, int stations,
                                     std::vector<double>& positions) {
  const Eigen::Vector2d normal = segment.normal();
  std::vector<Profile> profiles;
  profiles.reserve(static_cast<std::size_t>(stations));
  positions.reserve(static_cast<std::size_t>(stations));
  for (int i = 0; i < stations; ++i) {
    const double fraction = (i + 0.5) / stations;
    const Eigen::Vector2d centre = segment.at(fraction);
    const Eigen::Vector2d reach = (kReach * normal).cwiseAbs();
    const Eigen::Vector2d last(grey.cols - 1, grey.rows - 1);
    if (((centre - reach).array() < 0.0).any() || ((centre + reach).array() >= last.array()).any()) continue;
    Profile profile;
    for (int j = -kReach; j <= kReach; ++j) {
      profile[static_cast<std::size_t>(j + kReach)] = sample(grey, centre + j * normal);
    }
    profiles.push_back(profile);
    positions.push_back(2.0 * fraction - 1.0);
  }
  return profiles;
}

/// Mean step across the segment, grey levels: positive if the right side is brighter.
double mean_step(const std::vector<Profile>& profiles) {
  double sum = 0.0;
  for (const Profile& profile : profiles) sum += profile[kReach + 1] - profile[kReach - 1];
  return profiles.empty() ? 0.0 : sum / static_cast<double>(profiles.size());
}

/// Where the gradient of the given sign is greatest, if that is a peak.
std::optional<double> peak_offset(const Profile& profile, double sign) {
  const auto gradient = [&](int j) {
    const auto i = static_cast<std::size_t>(j + kReach);
    return 0.5 * sign * (profile[i + 1] - profile[i - 1]);
  };
  int best = 0;
  for (const int j : {-1, 1}) {
    if (gradient(j) > gradient(best)) best = j;
  }
  const double before = gradient(best - 1);
  const double peak = gradient(best);
  const double after = gradient(best + 1);
  const double curvature = before - 2.0 * peak + after;
  if (peak < kMinGradient || before > peak || after > peak || curvature >= 0.0) return std::nullopt;
  return best + 0.5 * (before - after) / curvature;
}

/// offset = mid + slope * position.
struct OffsetLine {
  double mid = 0.0;
  double slope = 0.0;
  double end_sigma = kDetectorSigma;
};

/// Least squares with Cauchy weights, which leave stray peaks without a say.
OffsetLine fit_offsets(const std::vector<Peak>& peaks) {
  constexpr int kIterations = 4;
  constexpr double kScale = 0.3;  // pixels
  OffsetLine line;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    double w = 0, wp = 0, wpp = 0, wo = 0, wpo = 0, wrr = 0;
    for (const Peak& peak : peaks) {
      const double residual = peak.offset - line.mid - line.slope * peak.position;
      const double weight = iteration == 0 ? 1.0 : 1.0 / (1.0 + residual * residual / (kScale * kScale));
      w += weight;
      wp += weight * peak.position;
      wpp += weight * peak.position * peak.position;
      wo += weight * peak.offset;
      wpo += weight * peak.position * peak.offset;
      wrr += weight * residual * residual;
    }
    const double determinant = w * wpp - wp * wp;
    if (determinant <= 1e-9) return line;
    line.mid = (wpp * wo - wp * wpo) / determinant;
    line.slope = (w * wpo - wp * wo) / determinant;
    const double variance = kCorrelatedStations * wrr / w;
    const double end_variance = variance * (wpp + 2.0 * std::abs(wp) + w) / determinant;
    line.end_sigma = std::hypot(std::sqrt(end_variance), kSigmaFloor);
  }
  return line;
}

}  // namespace

Segment refine_segment(const cv::Mat& grey, const Segment& segment) {
  const int stations = std::clamp(static_cast<int>(segment.length() / kStationSpacing), 8, kMaxStations);
  std::vector<double> positions;
  const std::vector<Profile> profiles = sample_profiles(grey, segment, stations, positions);
  const double sign = mean_step(profiles) < 0.0 ? -1.0 : 1.0;

  std::vector<Peak> peaks;
  peaks.reserve(profiles.size());
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    if (const auto offset = peak_offset(profiles[i], sign)) peaks.push_back({positions[i], *offset});
  }
  OffsetLine line;
  if (static_cast<double>(peaks.size()) >= kMinPeakShare * stations) line = fit_offsets(peaks);

  const Eigen::Vector2d normal = segment.normal();
  Segment refined{segment.start + (line.mid - line.slope) * normal, segment.end + (line.mid + line.slope) * normal,
                  std::min(line.end_sigma, kDetectorSigma)};
  if (sign < 0.0) std::swap(refined.start, refined.end);
  return refined;
}

}  // namespace eg::features
