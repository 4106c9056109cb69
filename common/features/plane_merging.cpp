#include "common/features/plane_merging.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "common/features/plane_contacts.hpp"

namespace eg::features {
namespace {

/// Fewer contacts say nothing about how two regions meet.
constexpr int kFewestContacts = 2;

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

/// Covariance of a region's plane by errors that go together over areas of the image.
Eigen::Matrix3d covariance_of(const PlaneRegion& region, const SharedErrors& errors) {
  double variance = 0;  // of one pixel, sigma², times the pixels that share it
  for (const auto& [sigma, pixels] : errors) variance += sigma * sigma * std::min(pixels, region.moments.pixels);
  return variance * region.moments.normal_matrix().inverse();
}

/// How far a region is from the plane of another one, metres, rms.
double distance_between(const PlaneRegion& region, const PlaneRegion& other) {
  const PlaneMoments& m = region.moments;
  const double inverse_depth = m.w / m.weight;
  const double squared = std::max(0.0, m.mean_squared_error(other.plane) - region.mean_squared_error);
  return std::sqrt(squared * m.pixels / m.weight) / (inverse_depth * inverse_depth);
}

/// Whether two planes are as near to each other as paint and plaster are thick, or errors explain their difference.
bool may_be_one(const PlaneRegion& left, const PlaneRegion& right, const SharedErrors& errors) {
  constexpr double kPaint = 0.0003;     // metres
  constexpr double kMaxSquared = 16.3;  // chi squared of 3 degrees of freedom: one of 1000 is above
  const bool left_is_smaller = left.support < right.support;
  if (distance_between(left_is_smaller ? left : right, left_is_smaller ? right : left) < kPaint) return true;
  const Eigen::Vector3d difference = left.plane - right.plane;
  const Eigen::Matrix3d covariance = covariance_of(left, errors) + covariance_of(right, errors);
  return difference.dot(covariance.inverse() * difference) <= kMaxSquared;
}

/// The best partner for `region` among those before it in `regions`; -1: none.
int coplanar_partner(const std::vector<PlaneRegion>& regions, std::size_t region, const std::vector<int>& new_index,
                     const TouchTable& table, const PlaneTolerance& tolerance, const SharedErrors& errors) {
  int best = -1;
  double best_error = 0;
  for (std::size_t i = 0; i < region; ++i) {
    const bool merged_away = new_index[i] != static_cast<int>(i);
    if (merged_away || table.touch(i, region) || !may_be_one(regions[i], regions[region], errors)) continue;
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
  std::vector<Contact> contacts = find_contacts(grid, clusters, step_tolerance);
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

void merge_coplanar(const BlockGrid& grid, const PlaneTolerance& tolerance, const SharedErrors& errors,
                    BlockClusters& clusters) {
  std::vector<PlaneRegion>& regions = clusters.regions;
  TouchTable table(find_contacts(grid, clusters, tolerance), regions.size());
  std::vector<int> new_index(regions.size());
  for (std::size_t region = 0; region < regions.size(); ++region) {
    new_index[region] = static_cast<int>(region);
    const int partner = coplanar_partner(regions, region, new_index, table, tolerance, errors);
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
