#include "common/features/plane_extraction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>
#include <string>

#include "common/base/check.hpp"
#include "common/features/plane_blocks.hpp"
#include "common/features/plane_clustering.hpp"
#include "common/features/plane_growing.hpp"
#include "common/features/plane_hull.hpp"
#include "common/features/plane_merging.hpp"
#include "common/features/plane_noise.hpp"
#include "common/features/plane_refit.hpp"

namespace eg::features {
namespace {

constexpr int kMaxRegions = 250;  // while working; labels have 8 bits

/// The Hessian form of 1/z = t · ray: t · x = 1 on the plane, hence normal = -t/|t| (towards the camera), distance =
/// 1/|t|.
geometry::Plane hessian_form(const InverseDepthPlane& t) { return {-t.normalized(), 1.0 / t.norm()}; }

/// Covariance of (normal, distance) from that of t, to first order.
Eigen::Matrix4d hessian_covariance(const geometry::Plane& plane, const Eigen::Matrix3d& covariance_of_t) {
  const Eigen::Vector3d& n = plane.normal;
  Eigen::Matrix<double, 4, 3> jacobian;
  jacobian.topRows<3>() = -plane.distance * (Eigen::Matrix3d::Identity() - n * n.transpose());
  jacobian.row(3) = plane.distance * plane.distance * n.transpose();
  return jacobian * covariance_of_t * jacobian.transpose();
}

/// What calibration leaves, and at the least what depth in whole units leaves: a tilt about the centroid and a change
/// of scale.
Eigen::Matrix4d systematic_covariance(const PlaneFeature& feature, double angle, double relative_distance) {
  const Eigen::Vector3d& n = feature.plane.normal;
  Eigen::Matrix<double, 4, 3> tilt;
  tilt.topRows<3>() = Eigen::Matrix3d::Identity() - n * n.transpose();
  tilt.row(3) = -feature.centroid.transpose() * tilt.topRows<3>();
  Eigen::Matrix4d covariance = angle * angle * tilt * tilt.transpose();
  const double sigma = relative_distance * feature.plane.distance;
  covariance(3, 3) += sigma * sigma;
  return covariance;
}

PlaneFeature make_feature(const PlaneRegion& region, const PlaneScatter& scatter, double warp, double warp_area,
                          const PlaneOptions& options) {
  PlaneFeature feature;
  feature.plane = hessian_form(region.plane);
  feature.support = static_cast<std::int32_t>(std::lround(region.support));
  const Eigen::Vector3d mean = scatter.point_sum / region.support;
  feature.centroid = mean - feature.plane.signed_distance(mean) * feature.plane.normal;
  feature.covariance =
      hessian_covariance(feature.plane, plane_covariance(region, scatter) + warp_covariance(region, warp, warp_area)) +
      systematic_covariance(feature, std::hypot(options.rounding, warp * options.systematic_angle),
                            std::hypot(options.rounding, warp * options.systematic_distance));
  return feature;
}

/// Gives every region its place in the result: by falling support, -1 for those that are too small.
std::vector<int> rank(std::vector<PlaneRegion>& regions, double min_pixels) {
  std::vector<int> order(regions.size());
  std::iota(order.begin(), order.end(), 0);
  const auto pixels = [&](int i) { return regions[static_cast<std::size_t>(i)].support; };
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return pixels(i) > pixels(j); });
  std::vector<int> place(regions.size(), -1);
  std::vector<PlaneRegion> ranked;
  for (const int i : order) {
    if (pixels(i) < min_pixels || ranked.size() == static_cast<std::size_t>(kMaxPlanes)) break;
    place[static_cast<std::size_t>(i)] = static_cast<int>(ranked.size());
    ranked.push_back(regions[static_cast<std::size_t>(i)]);
  }
  regions = std::move(ranked);
  return place;
}

void relabel(const std::vector<int>& new_region, std::vector<RegionPatch>& patches, cv::Mat& labels) {
  for (RegionPatch& patch : patches) patch.region = new_region[static_cast<std::size_t>(patch.region)];
  cv::Mat table = cv::Mat::zeros(1, 256, CV_8UC1);
  for (std::size_t i = 0; i < new_region.size(); ++i) {
    table.at<std::uint8_t>(static_cast<int>(i) + 1) = static_cast<std::uint8_t>(new_region[i] + 1);
  }
  cv::LUT(labels, table, labels);
}

}  // namespace

base::Status validate(const PlaneOptions& options) {
  const auto out_of_range = [](const char* name, const char* range) {
    return base::fail(std::string("plane option ") + name + " must be " + range);
  };
  if (options.block_size != 0 && (options.block_size < 4 || options.block_size > 128)) {
    return out_of_range("block_size", "0 or from 4 to 128");
  }
  if (!(options.min_valid_fraction > 0 && options.min_valid_fraction <= 1)) {
    return out_of_range("min_valid_fraction", "in (0, 1]");
  }
  if (!(options.max_error > 0)) return out_of_range("max_error", "positive");
  if (!(options.max_growth_error > 0)) return out_of_range("max_growth_error", "positive");
  if (!(options.max_warp_error > 0)) return out_of_range("max_warp_error", "positive");
  if (!(options.max_step > 0)) return out_of_range("max_step", "positive");
  if (!(options.flatness >= 0)) return out_of_range("flatness", "at least 0");
  if (!(options.lateral_sigma >= 0)) return out_of_range("lateral_sigma", "at least 0");
  if (!(options.min_support_fraction > 0 && options.min_support_fraction <= 1)) {
    return out_of_range("min_support_fraction", "in (0, 1]");
  }
  if (!(options.warp_blocks >= 0)) return out_of_range("warp_blocks", "at least 0");
  if (!(options.systematic_angle >= 0)) return out_of_range("systematic_angle", "at least 0");
  if (!(options.rounding >= 0)) return out_of_range("rounding", "at least 0");
  if (!(options.systematic_distance >= 0)) return out_of_range("systematic_distance", "at least 0");
  return {};
}

struct PlaneExtractor::Buffers {
  BlockGrid grid;
  RegionGrower grower;
  RegionLabels labels;
  std::vector<RegionPatch> patches;
};

PlaneExtractor::PlaneExtractor(const PlaneOptions& options) : options_(options), buffers_(new Buffers) {
  EG_CHECK(validate(options).has_value(), "plane options must be valid");
}
PlaneExtractor::~PlaneExtractor() = default;
PlaneExtractor::PlaneExtractor(PlaneExtractor&&) noexcept = default;
PlaneExtractor& PlaneExtractor::operator=(PlaneExtractor&&) noexcept = default;

PlaneExtraction PlaneExtractor::extract(const cv::Mat& depth, const geometry::CameraModel& camera) {
  EG_CHECK(depth.type() == CV_32FC1, "the depth image holds metres as floats");
  EG_CHECK(camera.fx != 0.0 && camera.fy != 0.0, "the camera has focal lengths");
  if (depth.empty()) return {{}, cv::Mat(depth.size(), CV_8UC1)};
  auto& [grid, grower, labels, patches] = *buffers_;
  const double min_support = options_.min_support_fraction * static_cast<double>(depth.total());

  const int block_size = block_size_of(options_, depth.size());
  const auto tolerance = [&](const PlaneTolerance::Limits& limits) {
    return PlaneTolerance(camera, options_.lateral_sigma, block_size * block_size, limits);
  };
  const PlaneTolerance sensor = tolerance({options_.max_error});
  build_blocks(depth, camera, options_, sensor, grid);
  const DepthErrors errors = measure_depth_errors(grid, sensor);
  const double noise = errors.noise;
  const double bend = std::min(1.0, errors.waviness / noise);
  const PlaneTolerance flat = tolerance({noise * options_.max_error, 0.0, bend});
  const PlaneTolerance coplanar = tolerance({noise * options_.max_error, noise * options_.flatness, bend});
  const PlaneTolerance warped = tolerance({noise * options_.max_warp_error, noise * options_.flatness});
  const PlaneTolerance step = tolerance({bend * noise * options_.max_step});
  constexpr double kPart = 0.2;  // of the smallest plane: what may still become one by being joined to others
  BlockClusters clusters = cluster_blocks(grid, flat, kPart * min_support, kMaxRegions);
  merge_continuous(grid, warped, step, clusters);
  constexpr double kWaveBlocks =
      2.0;  // blocks on a side that are off together: half a wave, sensors' waves being short
  const auto area = [&](double blocks) { return blocks * blocks * block_size * block_size; };
  const double warp_area = area(options_.warp_blocks);
  merge_coplanar(grid, coplanar, {{errors.waviness, area(kWaveBlocks)}, {errors.warp, warp_area}}, clusters);
  grower.grow(grid, clusters, flat, options_.max_growth_error, labels);

  collect_patches(grid, labels, patches);
  std::vector<PlaneRegion> regions = refit_regions(patches, static_cast<int>(clusters.regions.size()));
  relabel(rank(regions, min_support), patches, labels.labels);

  PlaneExtraction result;
  const std::vector<PlaneScatter> scatters = scatter_of_regions(patches, regions, grid.columns);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    result.planes.push_back(make_feature(regions[i], scatters[i], errors.warp, warp_area, options_));
  }
  add_hulls(labels.labels, grid, result.planes);
  result.labels = labels.labels.clone();
  result.warp = errors.warp;
  return result;
}

PlaneExtraction extract_planes(const cv::Mat& depth, const geometry::CameraModel& camera, const PlaneOptions& options) {
  return PlaneExtractor(options).extract(depth, camera);
}

}  // namespace eg::features
