#include "common/mapping/tile_page.hpp"

#include <zstd.h>

#include <cstring>
#include <utility>
#include <vector>

#include "common/base/check.hpp"
#include "common/mapping/tile_numbers.hpp"

namespace eg::mapping {
namespace {

constexpr int kZstdLevel = 1;
constexpr int kLeavesPerSide = kTileSide / kLeafSide;
constexpr int kLeaves = kLeavesPerSide * kLeavesPerSide * kLeavesPerSide;
constexpr std::size_t kSumBytes = kLeafVoxels * sizeof(std::int32_t);
constexpr std::size_t kColourBytes = 4 * kSumBytes;
constexpr std::size_t kHeadBytes = 2;  // number of the leaf in its tile, whether it has colour
constexpr std::size_t kMaxBytes = kLeaves * (kHeadBytes + 2 * kSumBytes + kColourBytes);
static_assert(sizeof(openvdb::Vec4i) == 4 * sizeof(std::int32_t));

openvdb::Coord origin_of(const Eigen::Vector3i& tile, int leaf) {
  const Eigen::Vector3i step(leaf / (kLeavesPerSide * kLeavesPerSide), leaf / kLeavesPerSide % kLeavesPerSide,
                             leaf % kLeavesPerSide);
  const Eigen::Vector3i origin = kTileSide * tile + kLeafSide * step;
  return {origin.x(), origin.y(), origin.z()};
}

void append(const void* data, std::size_t size, std::string& bytes) {
  bytes.append(static_cast<const char*>(data), size);
}

/// Frees the node above the leaves around a voxel if there are none any more.
template <typename Tree>
void drop_empty_node(const openvdb::Coord& voxel, Tree& tree) {
  using Node = typename Tree::RootNodeType::ChildNodeType::ChildNodeType;
  const Node* const node = tree.template probeConstNode<Node>(voxel);
  if (node != nullptr && node->isChildMaskOff()) tree.addTile(Node::LEVEL + 1, voxel, tree.background(), false);
}

/// A leaf of a packed tile, not yet in the trees.
struct UnpackedLeaf {
  LooseLeaf leaf;
  std::unique_ptr<ColourLeaf> colour;
};

bool is_in_range(const LeafSums& sums) {
  for (int voxel = 0; voxel < kLeafVoxels; ++voxel) {
    const std::int64_t weight = sums.weight[voxel];
    const std::int64_t distance = sums.distance[voxel];
    if (weight < 0 || weight > TsdfUnits::kFullWeight + TsdfUnits::kMaxWeight) return false;
    if (std::abs(distance) > weight * TsdfUnits::kTruncationSteps) return false;
    if (sums.colour == nullptr) continue;
    const openvdb::Vec4i& colour = sums.colour[voxel];
    if (colour[3] < 0 || colour[3] > weight) return false;
    for (int i = 0; i < 3; ++i) {
      if (colour[i] < 0 || colour[i] > std::int64_t{255} * colour[3]) return false;
    }
  }
  return true;
}

/// Takes the leaves off the bytes one by one.
class Unpacker {
 public:
  Unpacker(std::string_view bytes, const Eigen::Vector3i& tile) : bytes_(bytes), tile_(tile) {}

  [[nodiscard]] bool done() const { return bytes_.empty(); }

  base::Result<UnpackedLeaf> next() {
    if (bytes_.size() < kHeadBytes) return base::fail("a packed tile is cut short");
    const int number = static_cast<unsigned char>(bytes_[0]);
    const int has_colour = static_cast<unsigned char>(bytes_[1]);
    bytes_.remove_prefix(kHeadBytes);
    if (number <= last_ || number >= kLeaves || has_colour > 1) return base::fail("a packed tile has no such leaf");
    if (bytes_.size() < 2 * kSumBytes + (has_colour != 0 ? kColourBytes : 0)) {
      return base::fail("a packed tile is cut short");
    }
    last_ = number;
    const openvdb::Coord origin = origin_of(tile_, number);
    UnpackedLeaf unpacked{LooseLeaf(origin), nullptr};
    LeafSums sums = unpacked.leaf.sums();
    take(sums.weight, kSumBytes);
    take(sums.distance, kSumBytes);
    if (has_colour != 0) {
      unpacked.colour = std::make_unique<ColourLeaf>(origin, openvdb::Vec4i(0));
      sums.colour = unpacked.colour->buffer().data();
      take(sums.colour, kColourBytes);
    }
    if (!is_in_range(sums)) return base::fail("a packed tile has sums out of range");
    return unpacked;
  }

 private:
  void take(void* to, std::size_t size) {
    std::memcpy(to, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }

  std::string_view bytes_;
  Eigen::Vector3i tile_;
  int last_ = -1;
};

base::Result<std::string> decompress(std::string_view bytes) {
  const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN || size > kMaxBytes) {
    return base::fail("is no packed tile");
  }
  std::string raw(size, '\0');
  const std::size_t written = ZSTD_decompress(raw.data(), raw.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(written) != 0U || written != raw.size()) return base::fail("a packed tile cannot be unpacked");
  return raw;
}

}  // namespace

std::string pack_tile(const TsdfGrids& grids, const Eigen::Vector3i& tile) {
  std::string raw;
  for (int number = 0; number < kLeaves; ++number) {
    const openvdb::Coord origin = origin_of(tile, number);
    const IntLeaf* const weight = grids.weight.probeConstLeaf(origin);
    if (weight == nullptr) continue;
    const openvdb::Vec4i* const colour = grids.colour_sums(origin);
    raw.push_back(static_cast<char>(number));
    raw.push_back(colour != nullptr ? '\1' : '\0');
    append(weight->buffer().data(), kSumBytes, raw);
    append(grids.distance.probeConstLeaf(origin)->buffer().data(), kSumBytes, raw);
    if (colour != nullptr) append(colour, kColourBytes, raw);
  }
  std::string packed(ZSTD_compressBound(raw.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), kZstdLevel);
  EG_CHECK(ZSTD_isError(size) == 0U, "zstd compresses into a buffer of its own bound");
  packed.resize(size);
  return packed;
}

base::Status unpack_tile(std::string_view bytes, const Eigen::Vector3i& tile, TsdfGrids& grids) {
  const auto raw = decompress(bytes);
  if (!raw) return tl::make_unexpected(raw.error());
  std::vector<UnpackedLeaf> leaves;
  for (Unpacker unpacker(*raw, tile); !unpacker.done();) {
    auto leaf = unpacker.next();
    if (!leaf) return tl::make_unexpected(leaf.error());
    leaves.push_back(*std::move(leaf));
  }
  for (UnpackedLeaf& leaf : leaves) {
    grids.insert(std::move(leaf.leaf));
    if (leaf.colour) grids.colour.addLeaf(leaf.colour.release());
  }
  return {};
}

bool holds_leaves(const TsdfGrids& grids, const Eigen::Vector3i& tile) {
  for (int number = 0; number < kLeaves; ++number) {
    if (grids.weight.probeConstLeaf(origin_of(tile, number)) != nullptr) return true;
  }
  return false;
}

void erase_tile(const Eigen::Vector3i& tile, TsdfGrids& grids) {
  for (int number = 0; number < kLeaves; ++number) grids.erase(origin_of(tile, number));
  const openvdb::Coord origin = origin_of(tile, 0);
  drop_empty_node(origin, grids.weight);
  drop_empty_node(origin, grids.distance);
  drop_empty_node(origin, grids.colour);
}

}  // namespace eg::mapping
