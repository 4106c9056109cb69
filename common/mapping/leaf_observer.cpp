#include "common/mapping/leaf_observer.hpp"

#include <algorithm>

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

// Bounds of leaves: nearer, in metres, a leaf is looked at voxel by voxel; pixels and metres for rounding.
constexpr float kLeastDepth = 0.01F;
constexpr float kMargin = 0.5F;
constexpr float kRounding = 1e-3F;

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
      options_(options),
      steps_((options.voxel_size * camera_from_world_.rotation).cast<float>()),
      fx_(all_of(frame.camera.fx)),
      fy_(all_of(frame.camera.fy)),
      cx_(all_of(frame.camera.cx)),
      cy_(all_of(frame.camera.cy)),
      width_(all_of(frame.camera.width)),
      stride_(all_of(view_.stride())),
      right_(all_of(frame.camera.width - 1)),
      bottom_(all_of(frame.camera.height - 1)),
      voxel_size_(all_of(options.voxel_size)),
      least_truncation_(all_of(options.truncation_voxels * options.voxel_size)),
      truncation_sigmas_(all_of(options.truncation_sigmas)),
      best_variance_(all(TsdfUnits(options).best_variance())),
      steps_per_metre_(all(1.0F / TsdfUnits(options).metres_per_step())) {}

LeafObserver::Outlook LeafObserver::look(const openvdb::Coord& origin) const {
  const Eigen::Vector3d first = options_.voxel_size * Eigen::Vector3d(origin.x(), origin.y(), origin.z());
  const Eigen::Vector3f corner = (camera_from_world_ * first).cast<float>();
  // The leaf's corners: four on each of two faces.
  constexpr float kSide = kLeafSide - 1;
  const auto coordinates = [&](int axis, float along_z) {
    const float start = corner[axis] + along_z * steps_(axis, 2);
    const float x = kSide * steps_(axis, 0);
    const float y = kSide * steps_(axis, 1);
    return Float4{start, start + x, start + y, start + x + y};
  };
  const Points front{coordinates(0, 0.0F), coordinates(1, 0.0F), coordinates(2, 0.0F)};
  const Points back{coordinates(0, kSide), coordinates(1, kSide), coordinates(2, kSide)};
  const float nearest_z = least(min(front.z, back.z));
  const float farthest_z = greatest(max(front.z, back.z));
  if (nearest_z < kLeastDepth) return {Sight::mixed, {-1.0F}, corner};

  const Pixels a = project<Sight::plain>(front);
  const Pixels b = project<Sight::plain>(back);
  const float left = least(min(a.u, b.u)) - kMargin;
  const float right = greatest(max(a.u, b.u)) + kMargin;
  const float top = least(min(a.v, b.v)) - kMargin;
  const float bottom = greatest(max(a.v, b.v)) + kMargin;
  const auto last_x = static_cast<float>(view_.width() - 1);
  const auto last_y = static_cast<float>(view_.height() - 1);
  if (right < 0.0F || bottom < 0.0F || left > last_x || top > last_y) return {};
  Outlook outlook =
      look(corner,
           {static_cast<int>(std::max(left, 0.0F)), static_cast<int>(std::max(top, 0.0F)),
            static_cast<int>(std::min(right + 1.0F, last_x)), static_cast<int>(std::min(bottom + 1.0F, last_y))},
           nearest_z, farthest_z);
  const bool is_inside = left >= 0.0F && top >= 0.0F && right < last_x && bottom < last_y;
  if (outlook.sight == Sight::plain && !is_inside) outlook.sight = Sight::mixed;
  return outlook;
}

LeafObserver::Outlook LeafObserver::look(const Eigen::Vector3f& corner, const PixelRect& pixels, float nearest_z,
                                         float farthest_z) const {
  const DepthRange range = view_.range(pixels);
  if (range.high == 0.0F) return {};
  const float nearest = 1.0F / range.high;
  const float farthest = 1.0F / range.low;
  const auto limit_near = static_cast<float>(truncation(options_, static_cast<double>(nearest))) / range.obliqueness;
  const auto limit_far = static_cast<float>(truncation(options_, static_cast<double>(farthest))) / range.obliqueness;
  const float reach = std::max(limit_near, limit_far) + kRounding;
  if (nearest_z > farthest + reach || farthest_z < nearest - reach) return {};

  // With inverse depths q = plane·(x, y, z) / z + residual, a voxel is (1 - q z) / q along the axis from what its pixel
  // shows: out of the band if |1 - q z| is above q times the reach, which is largest at one end of the range.
  const Eigen::Vector3f plane = view_.plane_amid(pixels);
  const Residuals residuals = view_.residuals(pixels, plane);
  const float band = std::max(limit_near * range.high, limit_far * range.low) + kRounding * range.high;
  const float to_back = band - farthest_z * std::min(0.0F, residuals.low);
  const float to_front = band + farthest_z * std::max(0.0F, residuals.high);
  const Linear beyond{plane.dot(corner) - 1.0F, steps_.transpose() * plane};
  if (beyond.least() > to_back || beyond.greatest() < -to_front) return {};
  return {range.is_plain ? Sight::plain : Sight::mixed, {beyond.at_first - to_back, beyond.steps}, corner};
}

bool LeafObserver::observe(const Outlook& outlook, LeafReading& reading) const {
  static const bool has_avx2 = processor_has_avx2();
  return has_avx2 ? observe_voxels_avx2(outlook, reading) : observe_voxels(outlook, reading);
}

EG_AVX2 bool LeafObserver::observe_voxels_avx2(const Outlook& outlook, LeafReading& reading) const {
  return observe_voxels(outlook, reading);
}

inline bool LeafObserver::observe_voxels(const Outlook& outlook, LeafReading& reading) const {
  return outlook.sight == Sight::plain ? observe_rows<Sight::plain>(outlook, reading)
                                       : observe_rows<Sight::mixed>(outlook, reading);
}

template <LeafObserver::Sight sight>
inline bool LeafObserver::observe_rows(const Outlook& outlook, LeafReading& reading) const {
  const Linear& behind = outlook.behind;
  const Float4 along_z = {0.0F, 1.0F, 2.0F, 3.0F};
  const Points steps{along_z * steps_(0, 2), along_z * steps_(1, 2), along_z * steps_(2, 2)};
  const float least_behind = behind.at_first + std::min(0.0F, 3.0F * behind.steps.z());  // of a group
  Found found;
  std::size_t group = 0;
  for (int x = 0; x < kLeafSide; ++x) {
    const Eigen::Vector3f plane = outlook.corner + static_cast<float>(x) * steps_.col(0);
    for (int y = 0; y < kLeafSide; ++y) {
      const Eigen::Vector3f row = plane + static_cast<float>(y) * steps_.col(1);
      const float row_behind =
          least_behind + behind.steps.x() * static_cast<float>(x) + behind.steps.y() * static_cast<float>(y);
      for (int z = 0; z < kLeafSide; z += 4, ++group) {
        if (row_behind + static_cast<float>(z) * behind.steps.z() > 0.0F) {
          reading.weight[group] = kNone;
          continue;
        }
        const Eigen::Vector3f start = row + static_cast<float>(z) * steps_.col(2);
        observe_group<sight>({start.x() + steps.x, start.y() + steps.y, start.z() + steps.z}, group, reading, found);
      }
    }
  }
  reading.has_colour = any(found.surface);
  return any(found.near);
}

template <LeafObserver::Sight sight>
inline void LeafObserver::observe_group(const Points& points, std::size_t group, LeafReading& reading,
                                        Found& found) const {
  // Without branches: they would wait for the depth, and be foreseen too rarely.
  const Pixels pixels = project<sight>(points);
  const Distances measured = measure<sight>(points.z, sample<sight>(pixels));
  reading.weight[group] = weigh(measured) & measured.known;
  reading.distance[group] = round(min(measured.distance, measured.limit) * steps_per_metre_);
  found.near |= measured.known & (measured.distance < measured.limit);
  const Int4 beside = measured.known & (abs(measured.distance) < max(kColourVoxels * voxel_size_, measured.sigma));
  const Float4 pixel = to_float(truncate(pixels.v + kHalf)) * width_ + to_float(truncate(pixels.u + kHalf));
  reading.pixel[group] = truncate(pixel) | ~beside;  // -1 where it is not
  found.surface |= beside;
}

template <LeafObserver::Sight sight>
inline LeafObserver::Pixels LeafObserver::project(const Points& points) const {
  const Float4 inverse_z = 1.0F / points.z;
  const Float4 u = fx_ * points.x * inverse_z + cx_;
  const Float4 v = fy_ * points.y * inverse_z + cy_;
  if constexpr (sight == Sight::plain) return {~kNone, u, v};
  // So written that NaN is outside.
  const Int4 inside = (points.z > 0.0F) & (u >= 0.0F) & (v >= 0.0F) & (u < right_) & (v < bottom_);
  return {inside, inside ? u : all(0.0F), inside ? v : all(0.0F)};
}

template <LeafObserver::Sight sight>
inline LeafObserver::Depths LeafObserver::sample(const Pixels& pixels) const {
  const Float4 x = to_float(truncate(pixels.u));
  const Float4 y = to_float(truncate(pixels.v));
  const Int4 pixel = truncate(y * stride_ + x);  // exact: images have fewer than 2^24 pixels
  const float* const upper_row = view_.signed_inverse_depth();
  const float* const lower_row = upper_row + view_.stride();
  const Float4 upper01 = load_pairs(upper_row + pixel[0], upper_row + pixel[1]);
  const Float4 upper23 = load_pairs(upper_row + pixel[2], upper_row + pixel[3]);
  const Float4 lower01 = load_pairs(lower_row + pixel[0], lower_row + pixel[1]);
  const Float4 lower23 = load_pairs(lower_row + pixel[2], lower_row + pixel[3]);
  const float* const obliqueness = view_.signed_obliqueness();
  const Float4 oblique = {obliqueness[pixel[0]], obliqueness[pixel[1]], obliqueness[pixel[2]], obliqueness[pixel[3]]};

  // Bilinear in the inverse depth, which is exact on planes; beside a depth edge or a missing reading, where a mean
  // would be no surface, the nearest pixel's.
  Float4 share_u = pixels.u - x;
  Float4 share_v = pixels.v - y;
  if constexpr (sight == Sight::mixed) {
    const Int4 at_edge = sign(evens(upper01, upper23));
    share_u = at_edge ? (share_u < kHalf ? all(0.0F) : all(1.0F)) : share_u;
    share_v = at_edge ? (share_v < kHalf ? all(0.0F) : all(1.0F)) : share_v;
  }
  const Float4 upper_left = abs(evens(upper01, upper23));
  const Float4 upper_right = abs(odds(upper01, upper23));
  const Float4 lower_left = abs(evens(lower01, lower23));
  const Float4 lower_right = abs(odds(lower01, lower23));
  const Float4 upper = upper_left + share_u * (upper_right - upper_left);
  const Float4 lower = lower_left + share_u * (lower_right - lower_left);
  const Float4 inverse = upper + share_v * (lower - upper);
  if constexpr (sight == Sight::plain) return {inverse, oblique};
  return {pixels.inside ? inverse : all(0.0F), oblique};
}

template <LeafObserver::Sight sight>
inline LeafObserver::Distances LeafObserver::measure(const Float4& z, const Depths& depths) const {
  const Int4 is_seen = depths.inverse > 0.0F;
  const Float4 depth = 1.0F / (sight == Sight::plain ? depths.inverse : (is_seen ? depths.inverse : all(1.0F)));
  const Float4 distance = (depth - z) * abs(depths.obliqueness);
  const Float4 sigma = depth_sigma(depth);
  const Float4 limit = max(least_truncation_, truncation_sigmas_ * sigma);
  if constexpr (sight == Sight::plain) return {distance >= -limit, distance, limit, sigma};
  // Behind an object's outline its inside would border on the free space that is seen past it: a sheet of no surface.
  const Int4 is_known = is_seen & (distance >= (sign(depths.obliqueness) ? -voxel_size_ : -limit));
  return {is_known, distance, limit, sigma};
}

inline Int4 LeafObserver::weigh(const Distances& distances) const {
  // Farther behind the surface than that, a reading says less and less: the object may be thinner.
  const Float4 sigma = distances.sigma;
  const Float4 sure = max(voxel_size_, kSureSigmas * sigma);
  const Float4 weight = min(all(1.0F), best_variance_ / (sigma * sigma)) * static_cast<float>(TsdfUnits::kMaxWeight);
  const Int4 is_sure = distances.distance >= -sure;
  const Float4 certainty = is_sure ? all(1.0F) : (distances.limit + distances.distance) / (distances.limit - sure);
  return truncate(max(all(1.0F), weight * certainty + kHalf));
}

}  // namespace eg::mapping
