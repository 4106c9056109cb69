#include "common/mapping/tsdf_map.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <span>
#include <utility>

#include "common/base/check.hpp"
#include "common/mapping/integrator.hpp"
#include "common/mapping/mesh_welder.hpp"
#include "common/mapping/tile_block_reader.hpp"
#include "common/mapping/tile_page.hpp"
#include "common/mapping/tile_pager.hpp"
#include "common/mapping/tsdf_grids.hpp"
#include "common/mapping/vdb_format.hpp"

namespace eg::mapping {
namespace {

constexpr std::size_t kTilesAtOnce = 32;  // meshed side by side

base::Status check_input(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera) {
  const cv::Size size(frame.camera.width, frame.camera.height);
  if (size.empty()) return base::fail("frame: the camera has no pixels");
  if (frame.depth.type() != CV_32FC1 || frame.depth.size() != size) {
    return base::fail("frame: the depth image is not of the camera's size or not in metres");
  }
  if (frame.colour.type() != CV_8UC3 || frame.colour.size() != size) {
    return base::fail("frame: the colour image is not of the camera's size or not BGR");
  }
  if (!world_from_camera.rotation.allFinite() || !world_from_camera.translation.allFinite()) {
    return base::fail("frame: the pose is not finite");
  }
  return {};
}

}  // namespace

struct TsdfMap::Impl {
  TsdfOptions options;
  TsdfUnits units{options};
  TsdfGrids grids;
  TilePager pager{grids};
  std::vector<Eigen::Vector3i> changed_tiles;

  explicit Impl(const TsdfOptions& given) : options(given) {}

  base::Result<IntegrationSummary> apply(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera,
                                         Change change) {
    if (auto status = check_input(frame, world_from_camera); !status) return tl::make_unexpected(status.error());
    const FrameChange frame_change(frame, world_from_camera, options);
    if (auto status = pager.bring_back(tiles_of_leaves(frame_change.leaves())); !status) {
      return tl::make_unexpected(status.error());
    }
    const IntegrationResult result = frame_change.apply(change, grids);
    pager.note_changed(tiles_of_leaves(result.changed_leaves));
    const std::vector<Eigen::Vector3i> tiles = tiles_around_leaves(result.changed_leaves);
    changed_tiles.insert(changed_tiles.end(), tiles.begin(), tiles.end());
    keep_owned(changed_tiles);
    sort_unique(changed_tiles);
    return result.summary;
  }

  void keep_owned(std::vector<Eigen::Vector3i>& tiles) const {
    std::erase_if(tiles, [this](const Eigen::Vector3i& tile) { return !is_owned(options, tile); });
  }

  /// Meshes tiles side by side.
  base::Result<std::vector<TileMesh>> mesh(std::span<const Eigen::Vector3i> tiles) {
    std::vector<Eigen::Vector3i> around;
    for (const Eigen::Vector3i& tile : tiles) append_tiles_around_tile(tile, around);
    sort_unique(around);
    if (auto status = pager.bring_back(around); !status) return tl::make_unexpected(status.error());
    std::vector<TileMesh> meshes(tiles.size());
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
      meshes[i] =
          mesh_tile(read_tile(grids, units, tiles[i]), options.voxel_size, options.max_gradient * options.voxel_size);
    });
    return meshes;
  }
};

TsdfMap::TsdfMap(const TsdfOptions& options) : impl_(std::make_unique<Impl>(options)) {
  EG_CHECK(validate(options), "TSDF options are valid");
}

TsdfMap::~TsdfMap() = default;
TsdfMap::TsdfMap(TsdfMap&&) noexcept = default;
TsdfMap& TsdfMap::operator=(TsdfMap&&) noexcept = default;

const TsdfOptions& TsdfMap::options() const { return impl_->options; }

base::Result<IntegrationSummary> TsdfMap::integrate(const image::RectifiedFrame& frame,
                                                    const geometry::Pose& world_from_camera) {
  return impl_->apply(frame, world_from_camera, Change::add);
}

base::Result<IntegrationSummary> TsdfMap::deintegrate(const image::RectifiedFrame& frame,
                                                      const geometry::Pose& world_from_camera) {
  return impl_->apply(frame, world_from_camera, Change::take_back);
}

void TsdfMap::limit_memory(std::int64_t bytes, std::shared_ptr<TileStore> store) {
  impl_->pager.limit(bytes, std::move(store));
}

base::Status TsdfMap::keep_budget() { return impl_->pager.keep_budget(); }

base::Status TsdfMap::extract_mesh(const std::function<base::Status(const Mesh&)>& take) const {
  std::vector<Eigen::Vector3i> tiles = impl_->pager.tiles();
  impl_->keep_owned(tiles);
  MeshWelder welder;
  for (std::size_t i = 0; i < tiles.size(); i += kTilesAtOnce) {
    const auto some = std::span(tiles).subspan(i, std::min(kTilesAtOnce, tiles.size() - i));
    auto meshes = impl_->mesh(some);
    if (!meshes) return tl::make_unexpected(meshes.error());
    for (std::size_t k = 0; k < some.size(); ++k) {
      if (auto status = take(welder.add(some[k], std::move((*meshes)[k]))); !status) return status;
    }
    if (auto status = impl_->pager.keep_budget(); !status) return status;
  }
  return {};
}

base::Result<Mesh> TsdfMap::extract_mesh() const {
  Mesh mesh;
  const auto append = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
  const base::Status done = extract_mesh([&](const Mesh& piece) -> base::Status {
    append(piece.vertices, mesh.vertices);
    append(piece.normals, mesh.normals);
    append(piece.colours, mesh.colours);
    append(piece.triangles, mesh.triangles);
    return {};
  });
  if (!done) return tl::make_unexpected(done.error());
  return mesh;
}

base::Result<Mesh> TsdfMap::extract_tile(const Eigen::Vector3i& tile) const {
  return impl_->mesh({&tile, 1}).map([](std::vector<TileMesh> meshes) { return std::move(meshes.front().mesh); });
}

std::vector<Eigen::Vector3i> TsdfMap::take_changed_tiles() { return std::exchange(impl_->changed_tiles, {}); }

std::vector<Eigen::Vector3i> TsdfMap::tiles() const { return impl_->pager.tiles(); }

base::Result<std::string> TsdfMap::pack_tile(const Eigen::Vector3i& tile) const { return impl_->pager.packed(tile); }

base::Status TsdfMap::unpack_tile(const Eigen::Vector3i& tile, std::string_view bytes) {
  if (impl_->pager.is_away(tile) || holds_leaves(impl_->grids, tile)) return base::fail("a packed tile comes twice");
  if (auto status = mapping::unpack_tile(bytes, tile, impl_->grids); !status) return status;
  impl_->pager.note_changed({tile});
  append_tiles_around_tile(tile, impl_->changed_tiles);
  impl_->keep_owned(impl_->changed_tiles);
  sort_unique(impl_->changed_tiles);
  return {};
}

double TsdfMap::tile_size() const { return kTileSide * impl_->options.voxel_size; }

std::int64_t TsdfMap::leaf_count() const { return impl_->grids.weight.leafCount(); }

std::int64_t TsdfMap::memory_bytes() const {
  const TsdfGrids& grids = impl_->grids;
  return static_cast<std::int64_t>(grids.weight.memUsage() + grids.distance.memUsage() + grids.colour.memUsage());
}

base::Status TsdfMap::write_vdb(std::ostream& out) const { return write_grids(impl_->pager, impl_->options, out); }

base::Result<TsdfMap> TsdfMap::read_vdb(std::istream& in, const TsdfOptions& options) {
  if (auto status = validate(options); !status) return tl::make_unexpected(status.error());
  TsdfMap map(options);
  Impl& impl = *map.impl_;
  if (auto status = read_grids(in, options, impl.grids); !status) return tl::make_unexpected(status.error());
  impl.changed_tiles = tiles_with_leaves(impl.grids);
  impl.keep_owned(impl.changed_tiles);
  return map;
}

}  // namespace eg::mapping
