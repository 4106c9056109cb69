#include "common/features/plane_merging.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace eg::features {
namespace {

/// Fewer contacts say nothing about how two regions meet.
constexpr int kFewestContacts = 2;

/// Two neighbouring blocks of different regions.
struct Contact {
  int region_a = 0;
  int region_b = 0;
  double step = 0;  ///< from a to b halfway between the blocks, by the blocks' own planes; in limits
};

Eigen::Vector3d mean_ray(const PlaneMoments& m) { return Eigen::Vector3d(m.a, m.b, m.weight) / m.weight; }

double step_between(const BlockGrid& grid, std::size_t a, std::size_t b, const PlaneTolerance& tolerance) {
  const Eigen::Vector3d ray = 0.5 * (mean_ray(grid.moments[a]) + mean_ray(grid.moments[b]));
  const double w = 0.5 * (grid.moments[a].w / grid.moments[a].weight + grid.moments[b].w / grid.moments[b].weight);
  const InverseDepthPlane& plane_a = grid.fits[a].plane;
  const InverseDepthPlane& plane_b = grid.fits[b].plane;
  return (plane_b - plane_a).dot(ray) / std::sqrt(tolerance.squared_limit(w, 0.5 * (plane_a + plane_b)));
}

/// Contacts across at most one unusable block: those on a crease are mixed and often rejected.
std::vector<Contact> find_contacts(const BlockGrid& grid, const std::vector<int>& region_of_block,
                                   const PlaneTolerance& step_tolerance) {
  std::vector<Contact> contacts;
  const auto region_of = [&](int block) { return region_of_block[static_cast<std::size_t>(block)]; };
  const auto look = [&](int block, int stride, int room) {
    int other = block + stride;
    if (room > 1 && region_of(other) < 0) other += stride;
    if (region_of(other) < 0 || region_of(other) == region_of(block)) return;
    contacts.push_back(
        {region_of(block), region_of(other),
         step_between(grid, static_cast<std::size_t>(block), static_cast<std::size_t>(other), step_tolerance)});
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const int block = row * grid.columns + column;
      if (region_of(block) < 0) continue;
      if (column + 1 < grid.columns) look(block, 1, grid.columns - 1 - column);
      if (row + 1 < grid.rows) look(block, grid.columns, grid.rows - 1 - row);
    }
  }
  return contacts;
}

/// Whether the mean of `count` steps is within the limit, by the steps' sum. The fewer they are, the more of it is
/// noise: that of a block's plane halfway to its neighbour is three times that of its mean.
bool is_continuous(double sum, int count) {
  constexpr double kOfOneContact = 12.0;
  return std::abs(sum) <= count * std::sqrt(1.0 + kOfOneContact / count);
}

/// The pair of touching regions whose union has the smallest error, among those that may be joined; {-1, -1}: none.
std::pair<int, int> best_pair(const std::vector<Contact>& contacts, const std::vector<PlaneRegion>& regions,
                              const PlaneTolerance& tolerance) {
  std::map<std::pair<int, int>, std::pair<double, int>> steps;  // sum of steps from the first to the second, and number
  for (const auto& [a, b, step] : contacts) {
    if (a == b) continue;
    auto& [sum, count] = steps[std::minmax(a, b)];
    sum += a < b ? step : -step;
    count += 1;
  }
  std::pair<int, int> best{-1, -1};
  double best_error = 0;
  for (const auto& [pair, step] : steps) {
    if (step.second < kFewestContacts || !is_continuous(step.first, step.second)) continue;
    const auto fit = fit_union(regions[static_cast<std::size_t>(pair.first)],
                               regions[static_cast<std::size_t>(pair.second)], tolerance);
    if (fit && (best.first < 0 || fit->mean_squared_error < best_error)) {
      best = pair;
      best_error = fit->mean_squared_error;
    }
  }
  return best;
}

/// Which regions share a border.
class TouchTable {
 public:
  TouchTable(const std::vector<Contact>& contacts, std::size_t count) : count_(count), contacts_(count * count, 0) {
    for (const Contact& contact : contacts) {
      const auto a = static_cast<std::size_t>(contact.region_a);
      const auto b = static_cast<std::size_t>(contact.region_b);
      ++contacts_[a * count_ + b];
      ++contacts_[b * count_ + a];
    }
  }

  [[nodiscard]] bool touch(std::size_t a, std::size_t b) const { return contacts_[a * count_ + b] >= kFewestContacts; }

  /// From now on, `a` touches whatever `b` touches.
  void join(std::size_t a, std::size_t b) {
    for (std::size_t i = 0; i < count_; ++i) {
      contacts_[a * count_ + i] += contacts_[b * count_ + i];
      contacts_[i * count_ + a] = contacts_[a * count_ + i];
    }
  }

 private:
  std::size_t count_;
  std::vector<int> contacts_;
};

/// The best partner for `region` among those before it in `regions`; -1: none.
int coplanar_partner(const std::vector<PlaneRegion>& regions, std::size_t region, const std::vector<int>& new_index,
                     const TouchTable& table, const PlaneTolerance& tolerance) {
  int best = -1;
  double best_error = 0;
  for (std::size_t i = 0; i < region; ++i) {
    const bool merged_away = new_index[i] != static_cast<int>(i);
    if (merged_away || table.touch(i, region)) continue;
    const auto fit = fit_union(regions[i], regions[region], tolerance);
    if (fit && (best < 0 || fit->mean_squared_error < best_error)) {
      best = static_cast<int>(i);
      best_error = fit->mean_squared_error;
    }
  }
  return best;
}

}  // namespace

void merge_continuous(const BlockGrid& grid, const PlaneTolerance& tolerance, const PlaneTolerance& step_tolerance,
                      BlockClusters& clusters) {
  std::vector<PlaneRegion>& regions = clusters.regions;
  std::vector<Contact> contacts = find_contacts(grid, clusters.region_of_block, step_tolerance);
  for (;;) {
    const auto [kept, removed] = best_pair(contacts, regions, tolerance);
    if (kept < 0) return;
    regions[static_cast<std::size_t>(kept)].join(regions[static_cast<std::size_t>(removed)]);
    // Closes the gap in the numbering.
    regions.erase(regions.begin() + removed);
    std::vector<int> new_index(regions.size() + 1);
    std::iota(new_index.begin(), new_index.end(), 0);
    for (std::size_t i = static_cast<std::size_t>(removed); i < new_index.size(); ++i) new_index[i] -= 1;
    new_index[static_cast<std::size_t>(removed)] = kept;
    renumber(new_index, clusters.region_of_block);
    for (Contact& contact : contacts) {
      contact.region_a = new_index[static_cast<std::size_t>(contact.region_a)];
      contact.region_b = new_index[static_cast<std::size_t>(contact.region_b)];
    }
  }
}

void merge_coplanar(const BlockGrid& grid, const PlaneTolerance& tolerance, BlockClusters& clusters) {
  std::vector<PlaneRegion>& regions = clusters.regions;
  TouchTable table(find_contacts(grid, clusters.region_of_block, tolerance), regions.size());
  std::vector<int> new_index(regions.size());
  for (std::size_t region = 0; region < regions.size(); ++region) {
    new_index[region] = static_cast<int>(region);
    const int partner = coplanar_partner(regions, region, new_index, table, tolerance);
    if (partner < 0) continue;
    new_index[region] = partner;
    regions[static_cast<std::size_t>(partner)].join(regions[region]);
    regions[region] = {};
    table.join(static_cast<std::size_t>(partner), region);
  }
  renumber(new_index, clusters.region_of_block);
}

void renumber(const std::vector<int>& new_index, std::vector<int>& indices) {
  for (int& index : indices) {
    if (index >= 0) index = new_index[static_cast<std::size_t>(index)];
  }
}

}  // namespace eg::features
