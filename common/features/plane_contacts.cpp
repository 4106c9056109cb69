#include "common/features/plane_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace eg::features {
namespace {

/// What one step of disparity is about, in standard deviations of one reading.
constexpr double kWholeStep = 2.0;

Eigen::Vector3d mean_ray(const PlaneMoments& m) { return Eigen::Vector3d(m.a, m.b, m.weight) / m.weight; }

/// From its nearest to its farthest reading, in standard deviations of one reading: sqrt(12) times the spread of the
/// inverse depths on its plane.
double depth_range(const PlaneRegion& region) {
  const PlaneMoments& m = region.moments;
  const double p = region.plane.x(), q = region.plane.y();
  const double aa = m.aa - m.a * m.a / m.weight, ab = m.ab - m.a * m.b / m.weight, bb = m.bb - m.b * m.b / m.weight;
  return std::sqrt(std::max(0.0, 12.0 * (p * p * aa + 2 * p * q * ab + q * q * bb) / m.pixels));
}

/// A block of the grid and the way across a border that runs beside it.
struct Place {
  int column = 0;
  int row = 0;

  [[nodiscard]] Place moved(const Place& way, int steps) const {
    return {column + steps * way.column, row + steps * way.row};
  }
};

/// How two regions meet at one place of their border.
class BorderMeasure {
 public:
  BorderMeasure(const BlockGrid& grid, const BlockClusters& clusters, const PlaneTolerance& step_tolerance)
      : grid_(grid), region_of_block_(clusters.region_of_block), tolerance_(step_tolerance) {
    for (const PlaneRegion& region : clusters.regions) {
      is_even_.push_back(depth_range(region) > kWholeStep ? 1 : 0);
    }
  }

  [[nodiscard]] int region_at(const Place& place) const {
    const bool inside = place.column >= 0 && place.row >= 0 && place.column < grid_.columns && place.row < grid_.rows;
    return inside ? region_of_block_[index(place)] : -1;
  }

  /// The step from the region of block `a` to that of `b`, in limits. `way` leads from a to b.
  [[nodiscard]] double step(const Place& a, const Place& b, const Place& way) const {
    const bool even = is_even(a) && is_even(b);
    const auto before = even ? surface_behind(a, {-way.column, -way.row}) : std::nullopt;
    const auto after = even ? surface_behind(b, way) : std::nullopt;
    const PlaneMoments& block_a = grid_.moments[index(a)];
    const PlaneMoments& block_b = grid_.moments[index(b)];
    const InverseDepthPlane plane_a = before ? *before : grid_.fits[index(a)].plane;
    const InverseDepthPlane plane_b = after ? *after : grid_.fits[index(b)].plane;
    if (before && !after) return step_at(mean_ray(block_b), plane_a, plane_b, mean_of(block_b));
    if (after && !before) return step_at(mean_ray(block_a), plane_a, plane_b, mean_of(block_a));
    return step_at(0.5 * (mean_ray(block_a) + mean_ray(block_b)), plane_a, plane_b,
                   0.5 * (mean_of(block_a) + mean_of(block_b)));
  }

 private:
  [[nodiscard]] std::size_t index(const Place& place) const {
    return static_cast<std::size_t>(place.row * grid_.columns + place.column);
  }

  /// Whether disparity in whole steps leaves the course of the surface as it is.
  [[nodiscard]] bool is_even(const Place& place) const {
    return is_even_[static_cast<std::size_t>(region_at(place))] != 0;
  }

  static double mean_of(const PlaneMoments& block) { return block.w / block.weight; }

  [[nodiscard]] double step_at(const Eigen::Vector3d& ray, const InverseDepthPlane& plane_a,
                               const InverseDepthPlane& plane_b, double inverse_depth) const {
    return (plane_b - plane_a).dot(ray) / std::sqrt(tolerance_.squared_limit(inverse_depth, 0.5 * (plane_a + plane_b)));
  }

  /// The plane of the 3 x 3 blocks behind a block at the border, as seen from the border: the block itself may hold
  /// pixels of the other side. None where the region is not that deep.
  [[nodiscard]] std::optional<InverseDepthPlane> surface_behind(const Place& block, const Place& inwards) const {
    constexpr int kDepth = 3;
    constexpr int kEnough = 5;
    const int region = region_at(block);
    const Place sideways{inwards.row, inwards.column};
    PlaneMoments sum;
    int count = 0;
    for (int depth = 1; depth <= kDepth; ++depth) {
      for (int side = -1; side <= 1; ++side) {
        const Place place = block.moved(inwards, depth).moved(sideways, side);
        if (region_at(place) != region) continue;
        sum += grid_.moments[index(place)];
        ++count;
      }
    }
    if (count < kEnough) return std::nullopt;
    const PlaneFit fit = fit_plane(sum);
    return fit.valid ? std::optional(fit.plane) : std::nullopt;
  }

  const BlockGrid& grid_;
  const std::vector<int>& region_of_block_;
  const PlaneTolerance& tolerance_;
  std::vector<char> is_even_;
};

}  // namespace

std::vector<Contact> find_contacts(const BlockGrid& grid, const BlockClusters& clusters,
                                   const PlaneTolerance& step_tolerance) {
  const BorderMeasure border(grid, clusters, step_tolerance);
  std::vector<Contact> contacts;
  const auto look = [&](const Place& block, const Place& way) {
    const int region = border.region_at(block);
    Place other = block.moved(way, 1);
    if (border.region_at(other) < 0) other = block.moved(way, 2);
    const int other_region = border.region_at(other);
    if (other_region < 0 || other_region == region) return;
    contacts.push_back({region, other_region, border.step(block, other, way)});
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (border.region_at({column, row}) < 0) continue;
      look({column, row}, {1, 0});
      look({column, row}, {0, 1});
    }
  }
  return contacts;
}

}  // namespace eg::features
