#include "common/mapping/integrator.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>

#include "common/mapping/leaf_walk.hpp"
#include "common/mapping/tile_numbers.hpp"

namespace eg::mapping {
namespace {

using Short8 = std::int16_t __attribute__((vector_size(16)));
using Short4 = std::int16_t __attribute__((vector_size(8)));
using Byte8 = std::uint8_t __attribute__((vector_size(8)));

/// Product of numbers whose product is exact as a float.
Int4 multiply_small(Int4 a, Int4 b) { return truncate(to_float(a) * to_float(b)); }

/// Adds two pixels to the sums of two voxels. `weights`: of the first one four times, then of the second one.
void add_colours(const std::uint8_t* first, const std::uint8_t* second, Short8 weights, std::int32_t* sums) {
  constexpr Short8 kOneForAlpha = {255, 255, 255, 1, 255, 255, 255, 1};
  Byte8 bytes;
  std::memcpy(&bytes, first, 4);
  std::memcpy(reinterpret_cast<std::uint8_t*>(&bytes) + 4, second, 4);
  static_assert(TsdfUnits::kMaxWeight * 255 <= std::numeric_limits<std::int16_t>::max());
  const Short8 products = (__builtin_convertvector(bytes, Short8) & kOneForAlpha) * weights;
  const Short4 low = __builtin_shufflevector(products, products, 0, 1, 2, 3);
  const Short4 high = __builtin_shufflevector(products, products, 4, 5, 6, 7);
  store(load(sums) + __builtin_convertvector(low, Int4), sums);
  store(load(sums + 4) + __builtin_convertvector(high, Int4), sums + 4);
}

/// What is to be added to the colours of a leaf.
struct ColourChange {
  std::array<std::uint8_t, LeafReading::kGroups> groups;  ///< numbers of those that have any
  std::size_t count = 0;
  std::array<Int4, LeafReading::kGroups> weight;  ///< by numbers of groups
};

void update_colours(const ColourChange& change, const LeafReading& reading, const std::uint8_t* rgba,
                    openvdb::Vec4i* sums) {
  for (std::size_t i = 0; i < change.count; ++i) {
    const std::size_t group = change.groups[i];
    const Int4 offset = 4 * (reading.pixel[group] & (reading.pixel[group] >= 0));
    const auto weights = reinterpret_cast<Short8>(change.weight[group]);  // of the 16 bits beside each others are left
    auto* const sum = reinterpret_cast<std::int32_t*>(sums + 4 * group);
    add_colours(rgba + offset[0], rgba + offset[1], __builtin_shufflevector(weights, weights, 0, 0, 0, 0, 2, 2, 2, 2),
                sum);
    add_colours(rgba + offset[2], rgba + offset[3], __builtin_shufflevector(weights, weights, 4, 4, 4, 4, 6, 6, 6, 6),
                sum + 8);
  }
}

/// Adds the reading to the sums of a leaf or takes it back. Returns how many voxels changed.
template <Change change>
int update_leaf(const LeafReading& reading, const std::uint8_t* rgba, const LeafSums& sums) {
  Int4 changed = {0, 0, 0, 0};
  ColourChange colours;
  for (std::size_t group = 0; group < LeafReading::kGroups; ++group) {
    const Int4 weight = reading.weight[group];
    if (!any(weight)) continue;
    std::int32_t* const weight_sum = sums.weight + 4 * group;
    std::int32_t* const distance_sum = sums.distance + 4 * group;
    const Int4 before = load(weight_sum);
    // Taking back: a voxel with less weight never got this reading.
    const Int4 mask = change == Change::add ? before <= TsdfUnits::kFullWeight : before >= weight;
    const Int4 change_of_weight = mask & (change == Change::add ? weight : -weight);
    store(before + change_of_weight, weight_sum);
    store(load(distance_sum) + multiply_small(change_of_weight, reading.distance[group]), distance_sum);
    changed -= mask & (weight != 0);

    const Int4 has_colour = reading.pixel[group] >= 0;
    if (sums.colour == nullptr || !any(has_colour)) continue;
    __builtin_prefetch(sums.colour + 4 * group, 1);
    colours.groups[colours.count++] = static_cast<std::uint8_t>(group);
    colours.weight[group] = change_of_weight & has_colour;
  }
  if (sums.colour != nullptr) update_colours(colours, reading, rgba, sums.colour);
  return changed[0] + changed[1] + changed[2] + changed[3];
}

/// Asks for the sums of a leaf, which then come from memory while its voxels are looked up.
void prefetch(const LeafSums& sums) {
  constexpr std::size_t kLine = 64 / sizeof(std::int32_t);  // what the usual processors fetch at once
  for (std::size_t i = 0; i < kLeafVoxels; i += kLine) {
    __builtin_prefetch(sums.weight + i, 1);
    __builtin_prefetch(sums.distance + i, 1);
  }
}

/// One leaf of a frame's work. Leaves that are new stay outside the trees until all are done.
struct LeafTask {
  openvdb::Coord origin;
  LeafSums sums;
  std::optional<LooseLeaf> fresh;
  std::unique_ptr<ColourLeaf> fresh_colour;
  int changed = 0;
};

void run_task(const LeafObserver& observer, Change change, const Eigen::Vector3i& leaf, TsdfGrids& grids,
              LeafTask& task) {
  task.origin.reset(leaf.x() * kLeafSide, leaf.y() * kLeafSide, leaf.z() * kLeafSide);
  const LeafObserver::Outlook outlook = observer.look(task.origin);
  if (outlook.sight == LeafObserver::Sight::nothing) return;
  task.sums = grids.probe(task.origin);
  if (task.sums.weight != nullptr) prefetch(task.sums);
  if (change == Change::take_back && task.sums.weight == nullptr) return;
  LeafReading reading;
  if (!observer.observe(outlook, reading)) return;
  const std::uint8_t* const rgba = observer.view().colour();
  if (change == Change::take_back) {
    task.changed = update_leaf<Change::take_back>(reading, rgba, task.sums);
    return;
  }
  if (task.sums.weight == nullptr) task.sums = task.fresh.emplace(task.origin).sums();
  if (task.sums.colour == nullptr && reading.has_colour) {
    task.fresh_colour = std::make_unique<ColourLeaf>(task.origin, openvdb::Vec4i(0));
    task.sums.colour = task.fresh_colour->buffer().data();
  }
  task.changed = update_leaf<Change::add>(reading, rgba, task.sums);
}

bool is_empty(const LeafSums& sums) {
  return std::all_of(sums.weight, sums.weight + kLeafVoxels, [](std::int32_t weight) { return weight == 0; });
}

}  // namespace

FrameChange::FrameChange(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera,
                         const TsdfOptions& options)
    : observer_(frame, world_from_camera, options),
      leaves_(leaves_near_surface(observer_.view(), frame.camera, world_from_camera, options, kLeafSide)) {
  std::erase_if(leaves_, [&](const Eigen::Vector3i& leaf) { return !is_needed(options, leaf); });
}

IntegrationResult FrameChange::apply(Change change, TsdfGrids& grids) const {
  std::vector<LeafTask> tasks(leaves_.size());
  tbb::parallel_for(std::size_t{0}, tasks.size(),
                    [&](std::size_t i) { run_task(observer_, change, leaves_[i], grids, tasks[i]); });

  IntegrationResult result;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    LeafTask& task = tasks[i];
    if (task.changed == 0) continue;
    ++result.summary.leaves;
    result.summary.voxels += task.changed;
    result.changed_leaves.push_back(leaves_[i]);
    if (task.fresh) grids.insert(*std::move(task.fresh));
    if (task.fresh_colour) grids.colour.addLeaf(task.fresh_colour.release());
    if (change == Change::take_back && is_empty(task.sums)) grids.erase(task.origin);
  }
  return result;
}

}  // namespace eg::mapping
