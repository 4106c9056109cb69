#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "common/base/result.hpp"
#include "common/geometry/camera_model.hpp"
#include "common/image/rgbd_frame.hpp"

namespace eg::synthetic {

/// How a structured-light depth camera errs: the model of Handa, Whelan, McDonald, Davison (A Benchmark for RGB-D
/// Visual Odometry, 3D Reconstruction and SLAM, ICRA 2014), which is that of Barron and Malik (CVPR 2013):
///   disparity(x, y) = floor(k / Z(x + n_x, y + n_y) + n_d + 1/2),  Z' = k / disparity,
/// with k = steps_per_pixel * fx * baseline, n_x and n_y ~ N(0, lateral_sigma²), n_d ~ N(0, disparity_sigma²). Added to
/// it are the readings such cameras do not give: at depth edges, at grazing angles, and out of range.
struct DepthNoiseOptions {
  double baseline = 0.075;             ///< metres from camera to projector
  double steps_per_pixel = 8.0;        ///< disparity is quantised to 1/8 pixel
  double lateral_sigma = 0.5;          ///< pixels, per axis
  double disparity_sigma = 1.0 / 6.0;  ///< steps
  double edge_ratio = 1.05;            ///< neighbours whose depths differ by more are a depth edge
  double edge_dropout = 0.5;           ///< probability that a pixel at an edge has no reading
  double grazing_start_deg = 72.0;     ///< angle between ray and normal from which readings begin to fail ...
  double grazing_end_deg = 85.0;       ///< ... and where all have failed
  double min_depth = 0.4;              ///< metres
  double max_depth = 8.0;              ///< metres
};

/// Colour noise of a small sensor: variance = read_sigma² + shot_gain * value, in 8-bit units.
struct ColourNoiseOptions {
  double read_sigma = 1.0;
  double shot_gain = 0.01;
};

struct NoiseOptions {
  DepthNoiseOptions depth;
  ColourNoiseOptions colour;
};

/// Says which option is out of range.
base::Status validate(const NoiseOptions& options);

/// Noisy depth from exact depth, both CV_32FC1 in metres, 0: no reading. The camera's lens distortion is taken as none.
/// The result depends on the arguments only, not on the number of threads.
cv::Mat add_depth_noise(const cv::Mat& depth_metres, const geometry::CameraModel& camera,
                        const DepthNoiseOptions& options, std::uint64_t seed);

/// Noisy colour (CV_8UC3).
cv::Mat add_colour_noise(const cv::Mat& colour, const ColourNoiseOptions& options, std::uint64_t seed);

/// Noise on a frame, recorded or rendered: on depth and colour, or on its depth only. Every frame of a recording gets
/// noise of its own: seed and sequence are mixed.
image::RgbdFrame add_noise(const image::RgbdFrame& frame, const NoiseOptions& options, std::uint64_t seed);
image::RgbdFrame add_depth_noise(const image::RgbdFrame& frame, const DepthNoiseOptions& options, std::uint64_t seed);

}  // namespace eg::synthetic
