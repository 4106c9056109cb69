#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/mapping/tile_numbers.hpp"
#include "common/mapping/tile_store.hpp"
#include "common/mapping/tsdf_grids.hpp"

namespace eg::mapping {

/// Keeps the trees within a budget: the tiles that were touched longest ago go to a store and come back when they are
/// asked for. Without a store every tile stays in the trees.
class TilePager {
 public:
  explicit TilePager(TsdfGrids& grids) : grids_(grids) {}

  /// From now on the leaves shall take at most so many bytes. Call it once.
  void limit(std::int64_t budget, std::shared_ptr<TileStore> store);

  /// Sees to it that those of the tiles that exist are in the trees, whatever the budget. If one cannot be brought
  /// back, nothing is lost, and it fails again next time.
  base::Status bring_back(const std::vector<Eigen::Vector3i>& tiles);

  /// The tiles, which are in the trees, have changed: what the store has of them is no longer true.
  void note_changed(const std::vector<Eigen::Vector3i>& tiles);

  /// Takes tiles out of the trees until these are within the budget. A tile that cannot be put away stays; the error
  /// says why.
  base::Status keep_budget();

  /// Whether a tile is in the store and not in the trees.
  [[nodiscard]] bool is_away(const Eigen::Vector3i& tile) const;

  /// pack_tile(), wherever the tile is.
  [[nodiscard]] base::Result<std::string> packed(const Eigen::Vector3i& tile) const;

  /// Tiles that hold something, wherever they are, in lexicographic order.
  [[nodiscard]] std::vector<Eigen::Vector3i> tiles() const;

  [[nodiscard]] TsdfGrids& grids() { return grids_; }

 private:
  struct Page {
    std::uint64_t touched = 0;  ///< when: a count of calls
    bool in_trees = true;
    bool in_store = false;  ///< as it is now
  };

  base::Status bring_back(const Eigen::Vector3i& tile, Page& page);
  base::Status put_away(const Eigen::Vector3i& tile);

  TsdfGrids& grids_;
  std::int64_t budget_ = 0;
  std::shared_ptr<TileStore> store_;  ///< null: no budget, and no pages are kept
  std::map<Eigen::Vector3i, Page, TileOrder> pages_;
  std::uint64_t now_ = 0;
};

}  // namespace eg::mapping
