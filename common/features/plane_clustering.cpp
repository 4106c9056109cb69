#include "common/features/plane_clustering.hpp"

#include <algorithm>
#include <numeric>
#include <queue>
#include <tuple>

namespace eg::features {
namespace {

/// Disjoint sets of blocks with the region of each set.
class BlockSets {
 public:
  explicit BlockSets(const BlockGrid& grid) : parents_(grid.moments.size()) {
    std::iota(parents_.begin(), parents_.end(), 0);
    regions_.reserve(grid.moments.size());
    for (std::size_t i = 0; i < grid.moments.size(); ++i) {
      const PlaneFit& fit = grid.fits[i];
      regions_.push_back({grid.moments[i], fit.plane, fit.mean_squared_error, grid.moments[i].pixels});
    }
  }

  int find(int block) {
    while (parent(block) != block) block = parent(block) = parent(parent(block));
    return block;
  }

  [[nodiscard]] const PlaneRegion& region(int root) const { return regions_[static_cast<std::size_t>(root)]; }

  void unite(int a, int b) {
    if (region(a).support < region(b).support) std::swap(a, b);
    parent(b) = a;
    regions_[static_cast<std::size_t>(a)].join(region(b));
  }

 private:
  int& parent(int block) { return parents_[static_cast<std::size_t>(block)]; }

  std::vector<int> parents_;
  std::vector<PlaneRegion> regions_;
};

/// Two neighbouring blocks and the error of the union of the sets they belonged to when it was last computed.
struct Edge {
  double cost = 0;
  int a = 0;
  int b = 0;
  double pixels = 0;  ///< of that union; sets only grow, so another number tells that the cost is out of date

  bool operator>(const Edge& other) const { return std::tie(cost, a, b) > std::tie(other.cost, other.a, other.b); }
};

/// The heap of edges. An edge whose sets have grown is brought up to date only when it reaches the top: a large region
/// has hundreds of edges, and refreshing all of them at every merge would cost more than everything else together.
class EdgeHeap {
 public:
  EdgeHeap(BlockSets& sets, const PlaneTolerance& tolerance, std::size_t max_edges)
      : sets_(sets), tolerance_(tolerance), heap_({}, reserved(max_edges)) {}

  void push(int a, int b) {
    const int root_a = sets_.find(a);
    const int root_b = sets_.find(b);
    if (root_a == root_b) return;
    const auto fit = fit_union(sets_.region(root_a), sets_.region(root_b), tolerance_);
    if (fit) heap_.push({fit->mean_squared_error, a, b, union_pixels(root_a, root_b)});
  }

  void merge_all() {
    while (!heap_.empty()) {
      const Edge edge = heap_.top();
      heap_.pop();
      const int root_a = sets_.find(edge.a);
      const int root_b = sets_.find(edge.b);
      if (root_a == root_b) continue;
      if (edge.pixels == union_pixels(root_a, root_b)) {
        sets_.unite(root_a, root_b);
      } else {
        push(edge.a, edge.b);
      }
    }
  }

 private:
  static std::vector<Edge> reserved(std::size_t count) {
    std::vector<Edge> edges;
    edges.reserve(count);
    return edges;
  }

  [[nodiscard]] double union_pixels(int root_a, int root_b) const {
    return sets_.region(root_a).support + sets_.region(root_b).support;
  }

  BlockSets& sets_;
  const PlaneTolerance& tolerance_;
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> heap_;
};

void push_neighbours(const BlockGrid& grid, EdgeHeap& heap) {
  const auto usable = [&](int block) { return grid.fits[static_cast<std::size_t>(block)].valid; };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const int block = row * grid.columns + column;
      if (!usable(block)) continue;
      if (column + 1 < grid.columns && usable(block + 1)) heap.push(block, block + 1);
      if (row + 1 < grid.rows && usable(block + grid.columns)) heap.push(block, block + grid.columns);
    }
  }
}

/// The largest sets' roots, by falling number of pixels.
std::vector<int> largest_roots(const BlockGrid& grid, BlockSets& sets, double min_pixels, int max_regions) {
  std::vector<int> roots;
  for (int block = 0; block < grid.block_count(); ++block) {
    const bool is_root = grid.fits[static_cast<std::size_t>(block)].valid && sets.find(block) == block;
    if (is_root && sets.region(block).support >= min_pixels) roots.push_back(block);
  }
  std::stable_sort(roots.begin(), roots.end(),
                   [&](int a, int b) { return sets.region(a).support > sets.region(b).support; });
  if (roots.size() > static_cast<std::size_t>(max_regions)) roots.resize(static_cast<std::size_t>(max_regions));
  return roots;
}

}  // namespace

std::optional<PlaneFit> fit_union(const PlaneRegion& left, const PlaneRegion& right, const PlaneTolerance& tolerance) {
  const PlaneFit fit = fit_plane(left.moments + right.moments);
  const auto is_on_it = [&](const PlaneRegion& part) {
    return tolerance.accepts_union(part.moments, part.mean_squared_error, fit.plane);
  };
  return fit.valid && is_on_it(left) && is_on_it(right) ? std::optional(fit) : std::nullopt;
}

BlockClusters cluster_blocks(const BlockGrid& grid, const PlaneTolerance& tolerance, double min_pixels,
                             int max_regions) {
  BlockSets sets(grid);
  EdgeHeap heap(sets, tolerance, 2 * grid.moments.size());  // to the right and down
  push_neighbours(grid, heap);
  heap.merge_all();

  BlockClusters clusters;
  clusters.region_of_block.assign(static_cast<std::size_t>(grid.block_count()), -1);
  std::vector<int> region_of_root(clusters.region_of_block);
  for (const int root : largest_roots(grid, sets, min_pixels, max_regions)) {
    region_of_root[static_cast<std::size_t>(root)] = static_cast<int>(clusters.regions.size());
    clusters.regions.push_back(sets.region(root));
  }
  for (int block = 0; block < grid.block_count(); ++block) {
    const auto index = static_cast<std::size_t>(block);
    if (grid.fits[index].valid) {
      clusters.region_of_block[index] = region_of_root[static_cast<std::size_t>(sets.find(block))];
    }
  }
  return clusters;
}

}  // namespace eg::features
