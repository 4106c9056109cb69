#include "common/features/plane_blocks.hpp"

#include <algorithm>
#include <cmath>

namespace eg::features {
namespace {

constexpr float kMinDepth = 0.05F;  // metres; below and above, no sensor of this kind has a reading
constexpr float kMaxDepth = 100.0F;
constexpr int kMinBlockPixels = 12;

void invert_depth(const cv::Mat& depth, cv::Mat& inverse_depth) {
  inverse_depth.create(depth.size(), CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    const auto* z = depth.ptr<float>(v);
    auto* w = inverse_depth.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u) w[u] = z[u] > kMinDepth && z[u] < kMaxDepth ? 1.0F / z[u] : 0.0F;
  }
}

/// Unweighted moments of the pixels of one image row from column `begin` to before `end`, added to `moments`.
void add_row(const float* inverse_depth, const double* ray_x, double ray_y, int begin, int end, PlaneMoments& moments) {
  double n = 0, a = 0, aa = 0, w = 0, aw = 0, ww = 0;
  for (int u = begin; u < end; ++u) {
    if (inverse_depth[u] <= 0.0F) continue;
    const double x = ray_x[u];
    const double y = inverse_depth[u];
    n += 1;
    a += x;
    aa += x * x;
    w += y;
    aw += x * y;
    ww += y * y;
  }
  moments.pixels += n;
  moments.a += a;
  moments.b += ray_y * n;
  moments.w += w;
  moments.aa += aa;
  moments.ab += ray_y * a;
  moments.bb += ray_y * ray_y * n;
  moments.aw += aw;
  moments.bw += ray_y * w;
  moments.ww += ww;
}

PlaneFit fit_block(const PlaneMoments& moments, const cv::Rect& area, double min_valid_fraction,
                   const PlaneTolerance& tolerance) {
  const double enough = std::max<double>(kMinBlockPixels, min_valid_fraction * area.area());
  if (moments.pixels < enough) return {};
  PlaneFit fit = fit_plane(moments);
  fit.valid = fit.valid && tolerance.accepts(moments, fit.plane);
  return fit;
}

}  // namespace

int block_size_of(const PlaneOptions& options, const cv::Size& image) {
  if (options.block_size > 0) return options.block_size;
  constexpr double kBlockSizeAtVga = 10.0;
  const double scale = std::sqrt(image.area() / (640.0 * 480.0));
  return std::clamp(static_cast<int>(std::lround(kBlockSizeAtVga * scale)), 5, 64);
}

void weight_by_noise(PlaneMoments& moments) {
  moments.weight = moments.pixels;
  if (moments.pixels <= 0) return;
  const double sigma = inverse_depth_sigma(moments.w / moments.pixels);
  moments.scale(1.0 / (sigma * sigma));
}

cv::Rect BlockGrid::pixels_of(int column, int row) const {
  const cv::Rect block(column * block_size, row * block_size, block_size, block_size);
  return block & cv::Rect(0, 0, inverse_depth.cols, inverse_depth.rows);
}

void build_blocks(const cv::Mat& depth, const geometry::CameraModel& camera, const PlaneOptions& options,
                  const PlaneTolerance& tolerance, BlockGrid& grid) {
  grid.block_size = block_size_of(options, depth.size());
  grid.columns = (depth.cols + grid.block_size - 1) / grid.block_size;
  grid.rows = (depth.rows + grid.block_size - 1) / grid.block_size;
  grid.ray_x.resize(static_cast<std::size_t>(depth.cols));
  grid.ray_y.resize(static_cast<std::size_t>(depth.rows));
  for (int u = 0; u < depth.cols; ++u) grid.ray_x[static_cast<std::size_t>(u)] = (u - camera.cx) / camera.fx;
  for (int v = 0; v < depth.rows; ++v) grid.ray_y[static_cast<std::size_t>(v)] = (v - camera.cy) / camera.fy;
  invert_depth(depth, grid.inverse_depth);

  const auto count = static_cast<std::size_t>(grid.block_count());
  grid.moments.assign(count, {});
  grid.fits.assign(count, {});
  for (int v = 0; v < depth.rows; ++v) {
    const auto* w = grid.inverse_depth.ptr<float>(v);
    PlaneMoments* row = &grid.moments[static_cast<std::size_t>(v / grid.block_size * grid.columns)];
    for (int c = 0; c < grid.columns; ++c) {
      const int begin = c * grid.block_size;
      const int end = std::min(begin + grid.block_size, depth.cols);
      add_row(w, grid.ray_x.data(), grid.ray_y[static_cast<std::size_t>(v)], begin, end, row[c]);
    }
  }
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      const auto block = static_cast<std::size_t>(r * grid.columns + c);
      weight_by_noise(grid.moments[block]);
      grid.fits[block] = fit_block(grid.moments[block], grid.pixels_of(c, r), options.min_valid_fraction, tolerance);
    }
  }
}

}  // namespace eg::features
