#include "common/mapping/tsdf_map.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <utility>

#include "common/base/check.hpp"
#include "common/mapping/integrator.hpp"
#include "common/mapping/tile_block_reader.hpp"
#include "common/mapping/tile_mesher.hpp"
#include "common/mapping/tile_page.hpp"
#include "common/mapping/tsdf_grids.hpp"
#include "common/mapping/vdb_format.hpp"

namespace eg::mapping {
namespace {

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
  std::unique_ptr<TsdfGrids> grids = std::make_unique<TsdfGrids>();
  std::vector<Eigen::Vector3i> changed_tiles;

  explicit Impl(const TsdfOptions& given) : options(given) {}

  base::Result<IntegrationSummary> apply(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera,
                                         Change change) {
    if (auto status = check_input(frame, world_from_camera); !status) return tl::make_unexpected(status.error());
    const IntegrationResult result = integrate_frame(frame, world_from_camera, options, change, *grids);
    for (const Eigen::Vector3i& leaf : result.changed_leaves) append_tiles_around_leaf(leaf, changed_tiles);
    keep_owned(changed_tiles);
    sort_unique(changed_tiles);
    return result.summary;
  }

  void keep_owned(std::vector<Eigen::Vector3i>& tiles) const {
    std::erase_if(tiles, [this](const Eigen::Vector3i& tile) { return !is_owned(options, tile); });
  }

  [[nodiscard]] TileMesh mesh(const Eigen::Vector3i& tile) const {
    return mesh_tile(read_tile(*grids, units, tile), options.voxel_size, options.max_gradient * options.voxel_size);
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

Mesh TsdfMap::extract_mesh() const {
  std::vector<Eigen::Vector3i> tiles = tiles_with_leaves(*impl_->grids);
  impl_->keep_owned(tiles);
  std::vector<TileMesh> meshes(tiles.size());
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) { meshes[i] = impl_->mesh(tiles[i]); });
  return weld(std::move(meshes));
}

Mesh TsdfMap::extract_tile(const Eigen::Vector3i& tile) const { return impl_->mesh(tile).mesh; }

std::vector<Eigen::Vector3i> TsdfMap::take_changed_tiles() { return std::exchange(impl_->changed_tiles, {}); }

std::vector<Eigen::Vector3i> TsdfMap::tiles() const { return tiles_with_leaves(*impl_->grids); }

std::string TsdfMap::pack_tile(const Eigen::Vector3i& tile) const { return mapping::pack_tile(*impl_->grids, tile); }

base::Status TsdfMap::unpack_tile(const Eigen::Vector3i& tile, std::string_view bytes) {
  if (holds_leaves(*impl_->grids, tile)) return base::fail("a packed tile comes twice");
  if (auto status = mapping::unpack_tile(bytes, tile, *impl_->grids); !status) return status;
  append_tiles_around_tile(tile, impl_->changed_tiles);
  impl_->keep_owned(impl_->changed_tiles);
  sort_unique(impl_->changed_tiles);
  return {};
}

double TsdfMap::tile_size() const { return kTileSide * impl_->options.voxel_size; }

std::int64_t TsdfMap::leaf_count() const { return impl_->grids->weight->leafCount(); }

std::int64_t TsdfMap::memory_bytes() const {
  const TsdfGrids& grids = *impl_->grids;
  return static_cast<std::int64_t>(grids.weight->memUsage() + grids.distance.memUsage() + grids.colour.memUsage());
}

base::Status TsdfMap::write_vdb(std::ostream& out) const { return write_grids(*impl_->grids, impl_->options, out); }

base::Result<TsdfMap> TsdfMap::read_vdb(std::istream& in, const TsdfOptions& options) {
  if (auto status = validate(options); !status) return tl::make_unexpected(status.error());
  auto grids = read_grids(in, options);
  if (!grids) return tl::make_unexpected(grids.error());
  TsdfMap map(options);
  map.impl_->grids = std::move(*grids);
  map.impl_->changed_tiles = tiles_with_leaves(*map.impl_->grids);
  map.impl_->keep_owned(map.impl_->changed_tiles);
  return map;
}

}  // namespace eg::mapping
