#include "common/mapping/leaf_observer.hpp"

#include "common/geometry/depth_noise.hpp"

namespace eg::mapping {
namespace {

constexpr Int4 kNone = {0, 0, 0, 0};
constexpr float kHalf = 0.5F;
// Voxels beside a surface are less than one voxel's diagonal from it.
constexpr float kColourVoxels = 2.0F;
// If readings that came out too near counted less already at one standard deviation, noisy surfaces would move away from
// the camera by twice as much (docs/decisions/dense_map.md).
constexpr float kSureSigmas = 1.5F;

Float4 all_of(double x) { return all(static_cast<float>(x)); }

/// geometry::depth_sigma() of four.
Float4 depth_sigma(Float4 z) {
  const Float4 beyond = z - all_of(geometry::kDepthSigmaNearest);
  return all_of(geometry::kDepthSigmaFixed) + all_of(geometry::kDepthSigmaGrowth) * beyond * beyond;
}

Int4 round(Float4 x) { return truncate(x + (x < 0.0F ? all(-kHalf) : all(kHalf))); }

}  // namespace

LeafObserver::LeafObserver(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera,
                           const TsdfOptions& options)
    : view_(frame, options),
      camera_from_world_(world_from_camera.inverse()),
      voxel_size_m_(options.voxel_size),
      steps_((options.voxel_size * camera_from_world_.rotation).cast<float>()),
      fx_(all_of(frame.camera.fx)),
      fy_(all_of(frame.camera.fy)),
      cx_(all_of(frame.camera.cx)),
      cy_(all_of(frame.camera.cy)),
      right_(all_of(frame.camera.width - 1)),
      bottom_(all_of(frame.camera.height - 1)),
      continuity_(all(view_.continuity())),
      steepest_(all(view_.steepest())),
      voxel_size_(all_of(options.voxel_size)),
      least_truncation_(all_of(options.truncation_voxels * options.voxel_size)),
      truncation_sigmas_(all_of(options.truncation_sigmas)),
      best_variance_(all(TsdfUnits(options).best_variance())),
      steps_per_metre_(all(1.0F / TsdfUnits(options).metres_per_step())) {}

bool LeafObserver::observe(const openvdb::Coord& origin, LeafReading& reading) const {
  const Eigen::Vector3d first = voxel_size_m_ * Eigen::Vector3d(origin.x(), origin.y(), origin.z());
  const Eigen::Vector3f corner = (camera_from_world_ * first).cast<float>();
  const Float4 along_z = {0.0F, 1.0F, 2.0F, 3.0F};
  Int4 near = kNone;
  Int4 surface = kNone;
  for (int group = 0; group < LeafReading::kGroups; ++group) {
    const auto i = static_cast<std::size_t>(group);
    const int voxel = 4 * group;
    const Eigen::Vector3f start = corner + static_cast<float>(voxel / (kLeafSide * kLeafSide)) * steps_.col(0) +
                                  static_cast<float>(voxel / kLeafSide % kLeafSide) * steps_.col(1) +
                                  static_cast<float>(voxel % kLeafSide) * steps_.col(2);
    const Points points{start.x() + along_z * steps_(0, 2), start.y() + along_z * steps_(1, 2),
                        start.z() + along_z * steps_(2, 2)};
    const Pixels pixels = project(points);
    if (!any(pixels.inside)) {
      reading.weight[i] = kNone;
      continue;
    }
    const Measurements measured = measure(points.z, sample(pixels));
    reading.weight[i] = measured.weight;
    reading.distance[i] = measured.distance;
    const Int4 pixel = truncate(pixels.v + kHalf) * view_.width() + truncate(pixels.u + kHalf);
    reading.pixel[i] = measured.surface ? pixel : kNone - 1;
    near |= measured.near;
    surface |= measured.surface;
  }
  reading.has_colour = any(surface);
  return any(near);
}

LeafObserver::Pixels LeafObserver::project(const Points& points) const {
  const Float4 inverse_z = 1.0F / points.z;
  const Float4 u = fx_ * points.x * inverse_z + cx_;
  const Float4 v = fy_ * points.y * inverse_z + cy_;
  // So written that NaN is outside.
  const Int4 inside = (points.z > 0.0F) & (u >= 0.0F) & (v >= 0.0F) & (u < right_) & (v < bottom_);
  return {inside, inside ? u : all(0.0F), inside ? v : all(0.0F)};
}

LeafObserver::Depths LeafObserver::sample(const Pixels& pixels) const {
  const Int4 x = truncate(pixels.u);
  const Int4 y = truncate(pixels.v);
  const std::ptrdiff_t width = view_.width();
  Float4 upper_left, upper_right, lower_left, lower_right, obliqueness;
  for (int i = 0; i < 4; ++i) {
    const float* const pixel = view_.inverse_depth() + (y[i] * width + x[i]);
    upper_left[i] = pixel[0];
    upper_right[i] = pixel[1];
    lower_left[i] = pixel[width];
    lower_right[i] = pixel[width + 1];
    obliqueness[i] = view_.signed_obliqueness()[y[i] / DepthView::kBlock * view_.blocks_x() + x[i] / DepthView::kBlock];
  }
  // Bilinear in the inverse depth, which is exact on planes; beside a depth edge or a missing reading, where a mean
  // would be no surface, the nearest pixel's.
  const Float4 du = pixels.u - to_float(x);
  const Float4 dv = pixels.v - to_float(y);
  const Float4 upper = upper_left + du * (upper_right - upper_left);
  const Float4 lower = lower_left + du * (lower_right - lower_left);
  const Float4 upper_nearest = du < kHalf ? upper_left : upper_right;
  const Float4 lower_nearest = du < kHalf ? lower_left : lower_right;
  const Float4 low = min(min(upper_left, upper_right), min(lower_left, lower_right));
  const Float4 high = max(max(upper_left, upper_right), max(lower_left, lower_right));
  const Int4 at_edge = (high - low) * abs(obliqueness) > low * max(continuity_ * high, steepest_);
  const Float4 inverse = at_edge ? (dv < kHalf ? upper_nearest : lower_nearest) : upper + dv * (lower - upper);
  return {pixels.inside ? inverse : all(0.0F), obliqueness};
}

LeafObserver::Measurements LeafObserver::measure(const Float4& z, const Depths& depths) const {
  const Int4 is_seen = depths.inverse > 0.0F;
  const Float4 depth = 1.0F / (is_seen ? depths.inverse : all(1.0F));
  const Float4 distance = (depth - z) * abs(depths.obliqueness);
  const Float4 sigma = depth_sigma(depth);
  const Float4 limit = max(least_truncation_, truncation_sigmas_ * sigma);
  // Behind an object's outline its inside would border on the free space that is seen past it: a sheet of no surface.
  const Int4 is_known = is_seen & (distance >= (depths.obliqueness < 0.0F ? -voxel_size_ : -limit));
  // Farther behind the surface than that, a reading says less and less: the object may be thinner.
  const Float4 sure = max(voxel_size_, kSureSigmas * sigma);
  const Float4 certainty = distance >= -sure ? all(1.0F) : (limit + distance) / (limit - sure);
  const Float4 weight = min(all(1.0F), best_variance_ / (sigma * sigma)) * static_cast<float>(TsdfUnits::kMaxWeight);
  const Int4 rounded = truncate(max(all(1.0F), weight * certainty + kHalf));
  const Float4 cut_off = is_known ? min(distance, limit) : all(0.0F);
  return {rounded & is_known, round(cut_off * steps_per_metre_), is_known & (distance < limit),
          is_known & (abs(distance) < max(kColourVoxels * voxel_size_, sigma))};
}

}  // namespace eg::mapping
