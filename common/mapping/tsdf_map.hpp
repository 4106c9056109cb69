#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/geometry/pose.hpp"
#include "common/image/rgbd_frame.hpp"
#include "common/mapping/mesh.hpp"
#include "common/mapping/tile_store.hpp"
#include "common/mapping/tsdf_options.hpp"

namespace eg::mapping {

/// What one frame changed.
struct IntegrationSummary {
  int leaves = 0;           ///< blocks of 8 x 8 x 8 voxels that were changed
  std::int64_t voxels = 0;  ///< voxels that were changed
};

/// A coloured surface fused from depth images: a sparse truncated signed distance field (Curless and Levoy, SIGGRAPH
/// 1996) on OpenVDB trees (Museth, ACM TOG 2013).
///
/// Voxel (i, j, k) is the sample at the world point (i, j, k) · voxel_size. It holds, as integer sums over all readings
/// that saw it, the weight, the weighted distance to the surface (positive in free space) and the weighted colour.
/// Integer sums do not depend on the order of the readings and can be taken back exactly, so the field is the same for
/// any number of threads and any order of frames, and deintegrate() restores it to the last bit.
class TsdfMap {
 public:
  /// The options must be valid (validate()).
  explicit TsdfMap(const TsdfOptions& options = {});
  ~TsdfMap();
  TsdfMap(TsdfMap&&) noexcept;
  TsdfMap& operator=(TsdfMap&&) noexcept;

  [[nodiscard]] const TsdfOptions& options() const;

  /// Fuses a frame. Readings that are not finite or out of range are left out; a frame without any changes nothing.
  /// Fails when the images do not have the camera's size or the pose is not finite; the field is then untouched.
  base::Result<IntegrationSummary> integrate(const image::RectifiedFrame& frame,
                                             const geometry::Pose& world_from_camera);

  /// Takes back what integrate() added for the same frame and pose.
  base::Result<IntegrationSummary> deintegrate(const image::RectifiedFrame& frame,
                                               const geometry::Pose& world_from_camera);

  /// From now on the voxels take at most `bytes` of memory between two calls of keep_budget(): the tiles that were
  /// touched longest ago go to the store, and come back when a frame or the mesh needs them. Nothing that the map gives
  /// changes by that. What has to do with voxels can then fail, with the store's error, and changes nothing if it does.
  /// Call it once.
  void limit_memory(std::int64_t bytes, std::shared_ptr<TileStore> store);

  /// Puts tiles away until the voxels are within the budget. A tile that cannot be put away stays in memory; the error
  /// says why.
  base::Status keep_budget();

  /// The zero level of the field, welded, in an order that depends on the field alone.
  [[nodiscard]] base::Result<Mesh> extract_mesh() const;

  /// The same piece by piece, for meshes larger than memory: `take` gets vertices that no piece before had, and
  /// triangles between the vertices of all pieces so far, counted through. Its error ends it. Keeps the budget.
  base::Status extract_mesh(const std::function<base::Status(const Mesh& piece)>& take) const;

  /// The surface inside one tile: vertices on the border between tiles are the same to the bit on both sides.
  [[nodiscard]] base::Result<Mesh> extract_tile(const Eigen::Vector3i& tile) const;

  /// Tiles whose surface may have changed since the last call, in lexicographic order. May name tiles that are empty
  /// now.
  std::vector<Eigen::Vector3i> take_changed_tiles();

  /// Tiles that hold something, in lexicographic order.
  [[nodiscard]] std::vector<Eigen::Vector3i> tiles() const;

  /// All that is known of a tile, to the last bit, as packed bytes.
  [[nodiscard]] base::Result<std::string> pack_tile(const Eigen::Vector3i& tile) const;

  /// Puts a tile in from what pack_tile() of a map with the same options gave. It must be empty so far. Refuses other
  /// bytes; the map is then untouched.
  base::Status unpack_tile(const Eigen::Vector3i& tile, std::string_view bytes);

  /// Edge length of a tile, metres.
  [[nodiscard]] double tile_size() const;

  /// Blocks of 8 x 8 x 8 voxels in memory, and the bytes they take.
  [[nodiscard]] std::int64_t leaf_count() const;
  [[nodiscard]] std::int64_t memory_bytes() const;

  /// Writes OpenVDB's file format with the grids "tsdf" (metres), "weight" and "colour" (red, green, blue in [0, 1]).
  /// Needs hardly any memory of its own and keeps the budget.
  [[nodiscard]] base::Status write_vdb(std::ostream& out) const;

  /// Reads what write_vdb() wrote, up to rounding of the means. Fails when the voxel size is not the one in `options`,
  /// or something is missing or out of range.
  static base::Result<TsdfMap> read_vdb(std::istream& in, const TsdfOptions& options);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace eg::mapping
