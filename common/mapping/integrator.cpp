#include "common/mapping/integrator.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <cmath>
#include <optional>

#include "common/mapping/depth_view.hpp"
#include "common/mapping/leaf_walk.hpp"

namespace eg::mapping {
namespace {

/// What a reading says about one voxel. No weight: nothing.
struct Measurement {
  std::int32_t weight = 0;
  std::int32_t distance_steps = 0;
  Colour colour{};
};

// std::lrint would be a call into the C library for every voxel.
std::int32_t round_to_int(float x) { return static_cast<std::int32_t>(x < 0.0F ? x - 0.5F : x + 0.5F); }

/// Looks voxels up in one frame.
class VoxelObserver {
 public:
  VoxelObserver(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera, const TsdfOptions& options)
      : options_(options),
        units_(options),
        view_(frame, options),
        fx_(static_cast<float>(frame.camera.fx)),
        fy_(static_cast<float>(frame.camera.fy)),
        cx_(static_cast<float>(frame.camera.cx)),
        cy_(static_cast<float>(frame.camera.cy)),
        camera_from_world_(world_from_camera.inverse()),
        voxel_size_(static_cast<float>(options.voxel_size)),
        longest_truncation_(static_cast<float>(truncation(options, options.max_depth))),
        steps_per_metre_(1.0F / units_.metres_per_step()) {}

  [[nodiscard]] const DepthView& view() const { return view_; }

  [[nodiscard]] Eigen::Vector3f voxel_in_camera(const openvdb::Coord& voxel) const {
    const Eigen::Vector3d point_in_world = options_.voxel_size * Eigen::Vector3d(voxel.x(), voxel.y(), voxel.z());
    return (camera_from_world_ * point_in_world).cast<float>();
  }

  /// The camera's displacement from a voxel to its neighbour along an axis of the world.
  [[nodiscard]] Eigen::Vector3f step_in_camera(int axis) const {
    return (options_.voxel_size * camera_from_world_.rotation.col(axis)).cast<float>();
  }

  /// Projective distance, made perpendicular: the voxel's distance from the plane of the surface that its pixel shows.
  /// In front of the surface it is cut off, not left out: seen free space removes what other views took for the inside
  /// of thin objects.
  [[nodiscard]] Measurement measure(const Eigen::Vector3f& point_in_camera) const {
    if (!(point_in_camera.z() > 0.0F)) return {};
    const float inverse_z = 1.0F / point_in_camera.z();
    const float u = fx_ * point_in_camera.x() * inverse_z + cx_;
    const float v = fy_ * point_in_camera.y() * inverse_z + cy_;
    const DepthView::Sample seen = view_.sample(u, v);
    if (seen.inverse_depth == 0.0F) return {};
    const float depth = 1.0F / seen.inverse_depth;
    const float distance = (depth - point_in_camera.z()) * seen.obliqueness;
    // Behind an object's outline its inside would border on the free space that is seen past it: a sheet of no surface.
    if (distance < (seen.at_edge ? -voxel_size_ : -longest_truncation_)) return {};
    const auto limit = static_cast<float>(truncation(options_, depth));
    if (distance < -limit) return {};
    const float weight = units_.weight(depth) * certainty(distance, limit);
    return {std::max(1, round_to_int(weight)), round_to_int(std::min(distance, limit) * steps_per_metre_),
            view_.colour_at(u, v)};
  }

 private:
  /// From one voxel behind the surface on, a reading says less and less: the object may be thinner.
  [[nodiscard]] float certainty(float distance, float limit) const {
    return distance >= -voxel_size_ ? 1.0F : (limit + distance) / (limit - voxel_size_);
  }

  TsdfOptions options_;
  TsdfUnits units_;
  DepthView view_;
  float fx_, fy_, cx_, cy_;
  geometry::Pose camera_from_world_;
  float voxel_size_;
  float longest_truncation_;
  float steps_per_metre_;
};

bool add(const Measurement& m, const LeafSums& sums, int voxel) {
  if (sums.weight[voxel] > TsdfUnits::kFullWeight) return false;
  sums.weight[voxel] += m.weight;
  sums.distance[voxel] += m.weight * m.distance_steps;
  sums.colour[voxel] += m.weight * openvdb::Vec3i(m.colour[0], m.colour[1], m.colour[2]);
  return true;
}

bool take_back(const Measurement& m, const LeafSums& sums, int voxel) {
  if (sums.weight[voxel] < m.weight) return false;  // it was never added
  sums.weight[voxel] -= m.weight;
  sums.distance[voxel] -= m.weight * m.distance_steps;
  sums.colour[voxel] -= m.weight * openvdb::Vec3i(m.colour[0], m.colour[1], m.colour[2]);
  return true;
}

/// Returns how many voxels changed.
template <Change change>
int update_leaf(const VoxelObserver& observer, const openvdb::Coord& origin, const LeafSums& sums) {
  const Eigen::Vector3f corner = observer.voxel_in_camera(origin);
  const Eigen::Vector3f step_x = observer.step_in_camera(0);
  const Eigen::Vector3f step_y = observer.step_in_camera(1);
  const Eigen::Vector3f step_z = observer.step_in_camera(2);
  int changed = 0;
  for (int voxel = 0; voxel < kLeafVoxels; ++voxel) {
    const openvdb::Coord local = IntLeaf::offsetToLocalCoord(static_cast<openvdb::Index>(voxel));
    const Eigen::Vector3f point_in_camera = corner + static_cast<float>(local.x()) * step_x +
                                            static_cast<float>(local.y()) * step_y +
                                            static_cast<float>(local.z()) * step_z;
    const Measurement measurement = observer.measure(point_in_camera);
    if (measurement.weight == 0) continue;
    changed += change == Change::add ? add(measurement, sums, voxel) : take_back(measurement, sums, voxel);
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

void run_task(const VoxelObserver& observer, Change change, LeafTask& task) {
  if (change == Change::take_back) {
    if (task.sums.weight != nullptr) task.changed = update_leaf<Change::take_back>(observer, task.origin, task.sums);
    return;
  }
  if (task.sums.weight == nullptr) task.sums = task.fresh.emplace(task.origin).sums();
  task.changed = update_leaf<Change::add>(observer, task.origin, task.sums);
}

bool is_empty(const LeafSums& sums) {
  return std::all_of(sums.weight, sums.weight + kLeafVoxels, [](std::int32_t weight) { return weight == 0; });
}

}  // namespace

IntegrationResult integrate_frame(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera,
                                  const TsdfOptions& options, Change change, TsdfGrids& grids) {
  const VoxelObserver observer(frame, world_from_camera, options);
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
