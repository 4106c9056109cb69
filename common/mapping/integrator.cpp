#include "common/mapping/integrator.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <optional>

#include "common/mapping/leaf_observer.hpp"
#include "common/mapping/leaf_walk.hpp"

namespace eg::mapping {
namespace {

/// Adds the reading to the sums of a leaf or takes it back. Returns how many voxels changed.
template <Change change>
int update_leaf(const LeafReading& reading, const std::uint8_t* bgr, const LeafSums& sums) {
  int changed = 0;
  for (int voxel = 0; voxel < kLeafVoxels; ++voxel) {
    const auto group = static_cast<std::size_t>(voxel / 4);
    const std::int32_t weight = reading.weight[group][voxel % 4];
    if (weight == 0) continue;
    if (change == Change::add && sums.weight[voxel] > TsdfUnits::kFullWeight) continue;
    if (change == Change::take_back && sums.weight[voxel] < weight) continue;  // it was never added
    const std::int32_t signed_weight = change == Change::add ? weight : -weight;
    const std::uint8_t* const pixel = bgr + 3 * static_cast<std::ptrdiff_t>(reading.pixel[group][voxel % 4]);
    sums.weight[voxel] += signed_weight;
    sums.distance[voxel] += signed_weight * reading.distance[group][voxel % 4];
    sums.colour[voxel] += signed_weight * openvdb::Vec3i(pixel[2], pixel[1], pixel[0]);
    ++changed;
  }
  return changed;
}

/// One leaf of a frame's work. Leaves that are new stay outside the trees until all are done.
struct LeafTask {
  openvdb::Coord origin;
  LeafSums sums;
  std::optional<LooseLeaf> fresh;
  int changed = 0;
};

std::vector<LeafTask> make_tasks(const std::vector<Eigen::Vector3i>& leaves, TsdfGrids& grids) {
  std::vector<LeafTask> tasks;
  tasks.reserve(leaves.size());
  for (const Eigen::Vector3i& leaf : leaves) {
    const openvdb::Coord origin(leaf.x() * kLeafSide, leaf.y() * kLeafSide, leaf.z() * kLeafSide);
    tasks.push_back({origin, grids.probe(origin), std::nullopt, 0});
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
  task.changed = update_leaf<Change::add>(reading, bgr, task.sums);
}

bool is_empty(const LeafSums& sums) {
  return std::all_of(sums.weight, sums.weight + kLeafVoxels, [](std::int32_t weight) { return weight == 0; });
}

}  // namespace

IntegrationResult integrate_frame(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera,
                                  const TsdfOptions& options, Change change, TsdfGrids& grids) {
  const LeafObserver observer(frame, world_from_camera, options);
  const auto leaves = leaves_near_surface(observer.view(), frame.camera, world_from_camera, options, kLeafSide);
  std::vector<LeafTask> tasks = make_tasks(leaves, grids);
  tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) { run_task(observer, change, tasks[i]); });

  IntegrationResult result;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    LeafTask& task = tasks[i];
    if (task.changed == 0) continue;
    ++result.summary.leaves;
    result.summary.voxels += task.changed;
    result.changed_leaves.push_back(leaves[i]);
    if (task.fresh) grids.insert(std::move(*task.fresh));
    if (change == Change::take_back && is_empty(task.sums)) grids.erase(task.origin);
  }
  return result;
}

}  // namespace eg::mapping
