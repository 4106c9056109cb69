#include "common/mapping/tile_pager.hpp"

#include <algorithm>
#include <utility>

#include "common/base/check.hpp"
#include "common/mapping/tile_block_reader.hpp"
#include "common/mapping/tile_page.hpp"

namespace eg::mapping {
namespace {

// Once the budget is reached so much of it is freed that not every frame has to put tiles away.
constexpr double kShareToKeep = 0.9;

}  // namespace

void TilePager::limit(std::int64_t budget, std::shared_ptr<TileStore> store) {
  EG_CHECK(store_ == nullptr && store != nullptr, "a map gets one store");
  budget_ = budget;
  store_ = std::move(store);
  for (const Eigen::Vector3i& tile : tiles_with_leaves(grids_)) pages_.try_emplace(tile);
}

base::Status TilePager::bring_back(const std::vector<Eigen::Vector3i>& tiles) {
  if (store_ == nullptr) return {};
  ++now_;
  for (const Eigen::Vector3i& tile : tiles) {
    const auto page = pages_.find(tile);
    if (page == pages_.end()) continue;
    if (!page->second.in_trees) {
      if (auto status = bring_back(tile, page->second); !status) return status;
    }
    page->second.touched = now_;
  }
  return {};
}

base::Status TilePager::bring_back(const Eigen::Vector3i& tile, Page& page) {
  const auto bytes = store_->get(tile);
  if (!bytes) return tl::make_unexpected(bytes.error());
  if (auto status = unpack_tile(*bytes, tile, grids_); !status) return status;
  page.in_trees = true;
  return {};
}

void TilePager::note_changed(const std::vector<Eigen::Vector3i>& tiles) {
  if (store_ == nullptr) return;
  for (const Eigen::Vector3i& tile : tiles) pages_[tile] = {now_, true, false};
}

base::Status TilePager::keep_budget() {
  if (store_ == nullptr || grids_.leaf_bytes() <= budget_) return {};
  std::vector<std::pair<std::uint64_t, Eigen::Vector3i>> candidates;
  for (const auto& [tile, page] : pages_) {
    if (page.in_trees) candidates.emplace_back(page.touched, tile);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto enough = static_cast<std::int64_t>(kShareToKeep * static_cast<double>(budget_));
  for (const auto& [touched, tile] : candidates) {
    if (grids_.leaf_bytes() <= enough) break;
    if (auto status = put_away(tile); !status) return status;
  }
  return {};
}

base::Status TilePager::put_away(const Eigen::Vector3i& tile) {
  if (!holds_leaves(grids_, tile)) {  // it was taken back
    pages_.erase(tile);
    return {};
  }
  Page& page = pages_.at(tile);
  if (!page.in_store) {
    if (auto status = store_->put(tile, pack_tile(grids_, tile)); !status) return status;
  }
  erase_tile(tile, grids_);
  page.in_trees = false;
  page.in_store = true;
  return {};
}

bool TilePager::is_away(const Eigen::Vector3i& tile) const {
  const auto page = pages_.find(tile);
  return page != pages_.end() && !page->second.in_trees;
}

base::Result<std::string> TilePager::packed(const Eigen::Vector3i& tile) const {
  return is_away(tile) ? store_->get(tile) : pack_tile(grids_, tile);
}

std::vector<Eigen::Vector3i> TilePager::tiles() const {
  std::vector<Eigen::Vector3i> tiles = tiles_with_leaves(grids_);
  for (const auto& [tile, page] : pages_) {
    if (!page.in_trees) tiles.push_back(tile);
  }
  sort_unique(tiles);
  return tiles;
}

}  // namespace eg::mapping
