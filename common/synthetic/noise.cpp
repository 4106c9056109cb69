#include "common/synthetic/noise.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/base/check.hpp"
#include "common/synthetic/depth_encoding.hpp"
#include "common/synthetic/fast_normal.hpp"

namespace eg::synthetic {
namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// Looks up the exact depth image in the way the noise model needs it.
class DepthField {
 public:
  DepthField(const cv::Mat& depth, const geometry::CameraModel& camera, double edge_ratio)
      : depth_(depth), camera_(camera), edge_ratio_(static_cast<float>(edge_ratio)) {}

  /// Whether depth jumps, or ends, between the pixel and one of its eight neighbours.
  [[nodiscard]] bool at_edge(int x, int y) const {
    float low = depth_.at<float>(y, x);
    float high = low;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, depth_.rows - 1); ++v) {
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, depth_.cols - 1); ++u) {
        low = std::min(low, depth_.at<float>(v, u));
        high = std::max(high, depth_.at<float>(v, u));
      }
    }
    return high > edge_ratio_ * low;
  }

  /// 1/z between pixels, 0 where there is none: linear on one surface, which is exact on a plane, and that of the
  /// nearest pixel where the surroundings are several surfaces.
  [[nodiscard]] double inverse_depth(double x, double y) const {
    x = std::clamp(x, 0.0, static_cast<double>(depth_.cols - 1));
    y = std::clamp(y, 0.0, static_cast<double>(depth_.rows - 1));
    const int left = std::clamp(static_cast<int>(x), 0, std::max(depth_.cols - 2, 0));
    const int top = std::clamp(static_cast<int>(y), 0, std::max(depth_.rows - 2, 0));
    const int right = std::min(left + 1, depth_.cols - 1);
    const int bottom = std::min(top + 1, depth_.rows - 1);
    const std::array<float, 4> z = {depth_.at<float>(top, left), depth_.at<float>(top, right),
                                    depth_.at<float>(bottom, left), depth_.at<float>(bottom, right)};
    const auto [low, high] = std::minmax_element(z.begin(), z.end());
    if (*high > edge_ratio_ * *low) {
      const float nearest = depth_.at<float>(static_cast<int>(y + 0.5), static_cast<int>(x + 0.5));
      return nearest > 0.0F ? 1.0 / nearest : 0.0;
    }
    if (*low <= 0.0F) return 0.0;
    const double sx = x - left;
    const double sy = y - top;
    return (1.0 - sy) * ((1.0 - sx) / z[0] + sx / z[1]) + sy * ((1.0 - sx) / z[2] + sx / z[3]);
  }

  /// Cosine of the angle between ray and surface normal at a pixel that is not at an edge. The inverse depth of a plane
  /// is linear in the pixel, and its gradient is the normal.
  [[nodiscard]] double cosine(int x, int y) const {
    const int left = std::max(x - 1, 0), right = std::min(x + 1, depth_.cols - 1);
    const int top = std::max(y - 1, 0), bottom = std::min(y + 1, depth_.rows - 1);
    if (left == right || top == bottom) return 1.0;
    const double w = 1.0 / depth_.at<float>(y, x);
    const double by_x =
        camera_.fx * (1.0 / depth_.at<float>(y, right) - 1.0 / depth_.at<float>(y, left)) / (right - left);
    const double by_y =
        camera_.fy * (1.0 / depth_.at<float>(bottom, x) - 1.0 / depth_.at<float>(top, x)) / (bottom - top);
    const Eigen::Vector3d ray = camera_.ray({x, y});
    const Eigen::Vector3d normal(by_x, by_y, w - by_x * ray.x() - by_y * ray.y());
    return std::abs(w) / (normal.norm() * ray.norm());
  }

 private:
  const cv::Mat& depth_;
  const geometry::CameraModel& camera_;
  float edge_ratio_;
};

/// Probability that a surface seen at this angle gives no reading.
double grazing_dropout(double cosine, const DepthNoiseOptions& options) {
  const double start = std::cos(radians(options.grazing_start_deg));
  const double end = std::cos(radians(options.grazing_end_deg));
  return std::clamp((start - cosine) / (start - end), 0.0, 1.0);
}

/// One reading of the camera at a pixel, metres; 0: none.
double read_depth(const DepthField& field, int x, int y, double steps, const DepthNoiseOptions& options,
                  base::Random& random) {
  // Drawn before any decision, so that what one pixel does leaves the noise of the others as it is.
  const double shift_x = options.lateral_sigma * fast_normal(random);
  const double shift_y = options.lateral_sigma * fast_normal(random);
  const double error = options.disparity_sigma * fast_normal(random);
  const double luck = random.uniform();

  const double inverse_depth = field.inverse_depth(x + shift_x, y + shift_y);
  if (inverse_depth <= 0.0) return 0.0;
  const double disparity = std::floor(steps * inverse_depth + error + 0.5);
  if (disparity < 1.0) return 0.0;
  const double depth = steps / disparity;
  if (depth < options.min_depth || depth > options.max_depth) return 0.0;
  if (field.at_edge(x, y)) return luck < options.edge_dropout ? 0.0 : depth;
  return luck < grazing_dropout(field.cosine(x, y), options) ? 0.0 : depth;
}

base::Random frame_random(std::uint64_t seed, const image::RgbdFrame& frame) {
  return base::Random(seed + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(frame.header.sequence + 1));
}

}  // namespace

base::Status validate(const NoiseOptions& options) {
  const DepthNoiseOptions& depth = options.depth;
  if (!(depth.baseline > 0)) return base::fail("noise: baseline must be positive");
  if (!(depth.steps_per_pixel > 0)) return base::fail("noise: steps_per_pixel must be positive");
  if (!(depth.lateral_sigma >= 0)) return base::fail("noise: lateral_sigma must not be negative");
  if (!(depth.disparity_sigma >= 0)) return base::fail("noise: disparity_sigma must not be negative");
  if (!(depth.edge_ratio > 1)) return base::fail("noise: edge_ratio must be above 1");
  if (!(depth.edge_dropout >= 0 && depth.edge_dropout <= 1)) return base::fail("noise: edge_dropout must be in [0, 1]");
  if (!(depth.grazing_start_deg >= 0 && depth.grazing_start_deg < depth.grazing_end_deg &&
        depth.grazing_end_deg <= 90)) {
    return base::fail("noise: grazing_start_deg must be below grazing_end_deg, both in [0, 90]");
  }
  if (!(depth.min_depth >= 0 && depth.min_depth < depth.max_depth)) {
    return base::fail("noise: min_depth must be below max_depth and not negative");
  }
  if (!(options.colour.read_sigma >= 0)) return base::fail("noise: read_sigma must not be negative");
  if (!(options.colour.shot_gain >= 0)) return base::fail("noise: shot_gain must not be negative");
  return {};
}

cv::Mat add_depth_noise(const cv::Mat& depth_metres, const geometry::CameraModel& camera,
                        const DepthNoiseOptions& options, std::uint64_t seed) {
  EG_CHECK(depth_metres.type() == CV_32FC1, "depth in metres is CV_32FC1");
  const DepthField field(depth_metres, camera, options.edge_ratio);
  const double steps = options.steps_per_pixel * camera.fx * options.baseline;
  cv::Mat noisy(depth_metres.size(), CV_32FC1);
  tbb::parallel_for(0, noisy.rows, [&](int y) {
    base::Random random = row_random(seed, y);
    auto* row = noisy.ptr<float>(y);
    for (int x = 0; x < noisy.cols; ++x) row[x] = static_cast<float>(read_depth(field, x, y, steps, options, random));
  });
  return noisy;
}

cv::Mat add_colour_noise(const cv::Mat& colour, const ColourNoiseOptions& options, std::uint64_t seed) {
  EG_CHECK(colour.type() == CV_8UC3, "colour is CV_8UC3");
  std::array<double, 256> sigma{};
  for (int value = 0; value < 256; ++value) {
    const double variance = options.read_sigma * options.read_sigma + options.shot_gain * value;
    sigma[static_cast<std::size_t>(value)] = std::sqrt(variance);
  }
  cv::Mat noisy(colour.size(), CV_8UC3);
  tbb::parallel_for(0, noisy.rows, [&](int y) {
    base::Random random = row_random(seed, y);
    const auto* exact = colour.ptr<std::uint8_t>(y);
    auto* row = noisy.ptr<std::uint8_t>(y);
    for (int i = 0; i < 3 * noisy.cols; ++i) {
      const double value = exact[i] + sigma[exact[i]] * fast_normal(random);
      row[i] = static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
    }
  });
  return noisy;
}

image::RgbdFrame add_noise(const image::RgbdFrame& frame, const NoiseOptions& options, std::uint64_t seed) {
  image::RgbdFrame noisy = add_depth_noise(frame, options.depth, seed);
  base::Random random = frame_random(seed, frame);
  random.next();  // the depth's
  noisy.colour = add_colour_noise(frame.colour, options.colour, random.next());
  return noisy;
}

image::RgbdFrame add_depth_noise(const image::RgbdFrame& frame, const DepthNoiseOptions& options, std::uint64_t seed) {
  const double units = frame.camera.depth_units_per_metre;
  image::RgbdFrame noisy = frame;
  noisy.depth = encode_depth(
      add_depth_noise(decode_depth(frame.depth, units), frame.camera, options, frame_random(seed, frame).next()),
      units);
  return noisy;
}

}  // namespace eg::synthetic
