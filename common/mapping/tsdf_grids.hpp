#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>

#include "common/geometry/depth_noise.hpp"
#include "common/mapping/tsdf_options.hpp"

/// What TsdfMap is made of. Private to common/mapping: OpenVDB's headers stay out of everyone else's compile.
namespace eg::mapping {

using IntTree = openvdb::Int32Tree;
using ColourTree = openvdb::tree::Tree4<openvdb::Vec4i, 5, 4, 3>::Type;
using IntLeaf = IntTree::LeafNodeType;
using ColourLeaf = ColourTree::LeafNodeType;

inline constexpr int kLeafSide = static_cast<int>(IntLeaf::DIM);
inline constexpr int kLeafVoxels = static_cast<int>(IntLeaf::SIZE);

/// Units of the integer sums. A reading has a weight from 1 to kMaxWeight and a distance of at most kTruncationSteps. A
/// voxel whose weight has come to kFullWeight, after thousands of the best readings, takes no more: no sum overflows.
class TsdfUnits {
 public:
  static constexpr std::int32_t kMaxWeight = 127;
  static constexpr std::int32_t kTruncationSteps = 1023;
  static constexpr std::int32_t kFullWeight = 1 << 21;
  static_assert(std::int64_t{kFullWeight + kMaxWeight} * kTruncationSteps <= std::numeric_limits<std::int32_t>::max());

  explicit TsdfUnits(const TsdfOptions& options)
      : metres_per_step_(static_cast<float>(truncation(options, options.max_depth) / kTruncationSteps)),
        best_variance_(static_cast<float>(square(geometry::depth_sigma(options.min_depth)))) {}

  [[nodiscard]] float metres_per_step() const { return metres_per_step_; }

  /// Of the best reading, which has the weight kMaxWeight, m²; the weight of the others is in inverse proportion to
  /// theirs.
  [[nodiscard]] float best_variance() const { return best_variance_; }

 private:
  static double square(double x) { return x * x; }

  float metres_per_step_;
  float best_variance_;
};

/// The sums at the voxels of one leaf, in OpenVDB's order (z fastest).
struct LeafSums {
  std::int32_t* weight = nullptr;
  std::int32_t* distance = nullptr;  ///< weight times signed distance, in TsdfUnits::metres_per_step()
  openvdb::Vec4i* colour = nullptr;  ///< weight times red, green, blue, 1; null: no colour yet
};

/// A leaf that is in no tree.
struct LooseLeaf {
  std::unique_ptr<IntLeaf> weight;
  std::unique_ptr<IntLeaf> distance;

  explicit LooseLeaf(const openvdb::Coord& origin)
      : weight(std::make_unique<IntLeaf>(origin, 0)), distance(std::make_unique<IntLeaf>(origin, 0)) {}

  [[nodiscard]] LeafSums sums() const { return {weight->buffer().data(), distance->buffer().data(), nullptr}; }
};

/// Weight and distance have the same leaves; colour has those near a surface, where alone it is wanted. The active
/// states of the voxels are not kept: a voxel is observed if it has weight.
struct TsdfGrids {
  IntTree weight{0};
  IntTree distance{0};
  ColourTree colour{openvdb::Vec4i(0)};

  /// Null pointers if there is no such leaf.
  [[nodiscard]] LeafSums probe(const openvdb::Coord& origin) {
    IntLeaf* const leaf = weight.probeLeaf(origin);
    if (leaf == nullptr) return {};
    return {leaf->buffer().data(), distance.probeLeaf(origin)->buffer().data(), colour_sums(origin)};
  }

  /// Null if there is no such leaf.
  [[nodiscard]] openvdb::Vec4i* colour_sums(const openvdb::Coord& origin) {
    ColourLeaf* const leaf = colour.probeLeaf(origin);
    return leaf == nullptr ? nullptr : leaf->buffer().data();
  }
  [[nodiscard]] const openvdb::Vec4i* colour_sums(const openvdb::Coord& origin) const {
    const ColourLeaf* const leaf = colour.probeConstLeaf(origin);
    return leaf == nullptr ? nullptr : leaf->buffer().data();
  }

  void insert(LooseLeaf leaf) {
    weight.addLeaf(leaf.weight.release());
    distance.addLeaf(leaf.distance.release());
  }

  void erase(const openvdb::Coord& origin) {
    const std::unique_ptr<IntLeaf> no_weight(weight.stealNode<IntLeaf>(origin, 0, false));
    const std::unique_ptr<IntLeaf> no_distance(distance.stealNode<IntLeaf>(origin, 0, false));
    const std::unique_ptr<ColourLeaf> no_colour(colour.stealNode<ColourLeaf>(origin, openvdb::Vec4i(0), false));
  }

  /// That the leaves take; what finds them takes some hundredths of it.
  [[nodiscard]] std::int64_t leaf_bytes() const {
    return static_cast<std::int64_t>(weight.leafCount()) * 2 *
               (sizeof(IntLeaf) + IntLeaf::SIZE * sizeof(std::int32_t)) +
           static_cast<std::int64_t>(colour.leafCount()) *
               (sizeof(ColourLeaf) + ColourLeaf::SIZE * sizeof(openvdb::Vec4i));
  }
};

}  // namespace eg::mapping
