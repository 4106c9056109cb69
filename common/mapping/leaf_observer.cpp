#include "common/mapping/leaf_observer.hpp"

#include "common/geometry/depth_noise.hpp"

namespace eg::mapping {
namespace {

constexpr Int4 kNone = {0, 0, 0, 0};
constexpr float kHalf = 0.5F;
// Voxels beside a surface are less than one voxel's diagonal from it.
constexpr float kColourVoxels = 2.0F;
// If readings that came out too near counted less already at one standard deviation, noisy surfaces would move away
// from the camera by twice as much (docs/decisions/dense_map.md).
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
      width_(all_of(frame.camera.width)),
      right_(all_of(frame.camera.width - 1)),
      bottom_(all_of(frame.camera.height - 1)),
      voxel_size_(all_of(options.voxel_size)),
      least_truncation_(all_of(options.truncation_voxels * options.voxel_size)),
      truncation_sigmas_(all_of(options.truncation_sigmas)),
      best_variance_(all(TsdfUnits(options).best_variance())),
      steps_per_metre_(all(1.0F / TsdfUnits(options).metres_per_step())) {}

bool LeafObserver::observe(const openvdb::Coord& origin, LeafReading& reading) const {
  const Eigen::Vector3d first = voxel_size_m_ * Eigen::Vector3d(origin.x(), origin.y(), origin.z());
  const Eigen::Vector3f corner = (camera_from_world_ * first).cast<float>();
  const Float4 along_z = {0.0F, 1.0F, 2.0F, 3.0F};
  const Points steps{along_z * steps_(0, 2), along_z * steps_(1, 2), along_z * steps_(2, 2)};
  Int4 near = kNone;
  Int4 surface = kNone;
  for (int group = 0; group < LeafReading::kGroups; ++group) {
    const auto i = static_cast<std::size_t>(group);
    const int voxel = 4 * group;
    const Eigen::Vector3f start = corner + static_cast<float>(voxel / (kLeafSide * kLeafSide)) * steps_.col(0) +
                                  static_cast<float>(voxel / kLeafSide % kLeafSide) * steps_.col(1) +
                                  static_cast<float>(voxel % kLeafSide) * steps_.col(2);
    const Points points{start.x() + steps.x, start.y() + steps.y, start.z() + steps.z};
    reading.weight[i] = kNone;
    const Pixels pixels = project(points);
    if (!any(pixels.inside)) continue;
    const Distances measured = measure(points.z, sample(pixels));
    if (!any(measured.known)) continue;
    reading.weight[i] = weigh(measured) & measured.known;
    reading.distance[i] = round(min(measured.distance, measured.limit) * steps_per_metre_) & measured.known;
    near |= measured.known & (measured.distance < measured.limit);
    const Int4 beside = measured.known & (abs(measured.distance) < max(kColourVoxels * voxel_size_, measured.sigma));
    const Float4 pixel = to_float(truncate(pixels.v + kHalf)) * width_ + to_float(truncate(pixels.u + kHalf));
    reading.pixel[i] = beside ? truncate(pixel) : kNone - 1;
    surface |= beside;
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
  const Float4 x = to_float(truncate(pixels.u));
  const Float4 y = to_float(truncate(pixels.v));
  const Int4 pixel = truncate(y * width_ + x);  // exact: images have fewer than 2^24 pixels
  const float* const upper_row = view_.signed_inverse_depth();
  const float* const lower_row = upper_row + view_.width();
  const Float4 upper01 = load_pairs(upper_row + pixel[0], upper_row + pixel[1]);
  const Float4 upper23 = load_pairs(upper_row + pixel[2], upper_row + pixel[3]);
  const Float4 lower01 = load_pairs(lower_row + pixel[0], lower_row + pixel[1]);
  const Float4 lower23 = load_pairs(lower_row + pixel[2], lower_row + pixel[3]);
  const float* const obliqueness = view_.signed_obliqueness();
  const Float4 oblique = {obliqueness[pixel[0]], obliqueness[pixel[1]], obliqueness[pixel[2]], obliqueness[pixel[3]]};

  // Bilinear in the inverse depth, which is exact on planes; beside a depth edge or a missing reading, where a mean
  // would be no surface, the nearest pixel's.
  const Int4 at_edge = sign(evens(upper01, upper23));
  const Float4 upper_left = abs(evens(upper01, upper23));
  const Float4 upper_right = abs(odds(upper01, upper23));
  const Float4 lower_left = abs(evens(lower01, lower23));
  const Float4 lower_right = abs(odds(lower01, lower23));
  const Float4 du = pixels.u - x;
  const Float4 dv = pixels.v - y;
  const Float4 share_u = at_edge ? (du < kHalf ? all(0.0F) : all(1.0F)) : du;
  const Float4 share_v = at_edge ? (dv < kHalf ? all(0.0F) : all(1.0F)) : dv;
  const Float4 upper = upper_left + share_u * (upper_right - upper_left);
  const Float4 lower = lower_left + share_u * (lower_right - lower_left);
  const Float4 inverse = upper + share_v * (lower - upper);
  return {pixels.inside ? inverse : all(0.0F), oblique};
}

LeafObserver::Distances LeafObserver::measure(const Float4& z, const Depths& depths) const {
  const Int4 is_seen = depths.inverse > 0.0F;
  const Float4 depth = 1.0F / (is_seen ? depths.inverse : all(1.0F));
  const Float4 distance = (depth - z) * abs(depths.obliqueness);
  const Float4 sigma = depth_sigma(depth);
  const Float4 limit = max(least_truncation_, truncation_sigmas_ * sigma);
  // Behind an object's outline its inside would border on the free space that is seen past it: a sheet of no surface.
  const Int4 is_known = is_seen & (distance >= (sign(depths.obliqueness) ? -voxel_size_ : -limit));
  return {is_known, distance, limit, sigma};
}

Int4 LeafObserver::weigh(const Distances& distances) const {
  // Farther behind the surface than that, a reading says less and less: the object may be thinner.
  const Float4 sigma = distances.sigma;
  const Float4 sure = max(voxel_size_, kSureSigmas * sigma);
  const Float4 certainty =
      distances.distance >= -sure ? all(1.0F) : (distances.limit + distances.distance) / (distances.limit - sure);
  const Float4 weight = min(all(1.0F), best_variance_ / (sigma * sigma)) * static_cast<float>(TsdfUnits::kMaxWeight);
  return truncate(max(all(1.0F), weight * certainty + kHalf));
}

}  // namespace eg::mapping
