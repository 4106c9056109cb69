#include "common/mapping/integrator.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>

#include "common/mapping/leaf_walk.hpp"
#include "common/mapping/tile_numbers.hpp"

namespace eg::mapping {
namespace {

Int4 load(const std::int32_t* from) {
  Int4 values;
  std::memcpy(&values, from, sizeof values);
  return values;
}

void store(Int4 values, std::int32_t* to) { std::memcpy(to, &values, sizeof values); }

/// Adds the reading to the sums of a leaf or takes it back. Returns how many voxels changed.
template <Change change>
int update_leaf(const LeafReading& reading, const std::uint8_t* bgr, const LeafSums& sums) {
  Int4 changed = {0, 0, 0, 0};
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
    store(load(distance_sum) + change_of_weight * reading.distance[group], distance_sum);
    changed -= mask & (weight != 0);
    if (sums.colour == nullptr) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::int32_t pixel = reading.pixel[group][i];
      if (pixel < 0 || change_of_weight[i] == 0) continue;
      const std::uint8_t* const colour = bgr + 3 * static_cast<std::ptrdiff_t>(pixel);
      auto* const colour_sum = reinterpret_cast<std::int32_t*>(sums.colour + 4 * group + i);
      store(load(colour_sum) + change_of_weight[i] * Int4{colour[2], colour[1], colour[0], 1}, colour_sum);
    }
  }
  return changed[0] + changed[1] + changed[2] + changed[3];
}

/// One leaf of a frame's work. Leaves that are new stay outside the trees until all are done.
struct LeafTask {
  openvdb::Coord origin;
  LeafSums sums;
  std::optional<LooseLeaf> fresh;
  std::unique_ptr<ColourLeaf> fresh_colour;
  int changed = 0;
};

std::vector<LeafTask> make_tasks(const std::vector<Eigen::Vector3i>& leaves, TsdfGrids& grids) {
  std::vector<LeafTask> tasks;
  tasks.reserve(leaves.size());
  for (const Eigen::Vector3i& leaf : leaves) {
    const openvdb::Coord origin(leaf.x() * kLeafSide, leaf.y() * kLeafSide, leaf.z() * kLeafSide);
    tasks.push_back({origin, grids.probe(origin), std::nullopt, nullptr, 0});
  }
  return tasks;
}

void run_task(const LeafObserver& observer, Change change, LeafTask& task) {
  if (change == Change::take_back && task.sums.weight == nullptr) return;
  LeafReading reading;
  if (!observer.observe(task.origin, reading)) return;
  const std::uint8_t* const bgr = observer.view().colour();
  if (change == Change::take_back) {
    task.changed = update_leaf<Change::take_back>(reading, bgr, task.sums);
    return;
  }
  if (task.sums.weight == nullptr) task.sums = task.fresh.emplace(task.origin).sums();
  if (task.sums.colour == nullptr && reading.has_colour) {
    task.fresh_colour = std::make_unique<ColourLeaf>(task.origin, openvdb::Vec4i(0));
    task.sums.colour = task.fresh_colour->buffer().data();
  }
  task.changed = update_leaf<Change::add>(reading, bgr, task.sums);
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
  std::vector<LeafTask> tasks = make_tasks(leaves_, grids);
  tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) { run_task(observer_, change, tasks[i]); });

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
