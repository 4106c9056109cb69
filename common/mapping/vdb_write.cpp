#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>

#include <array>
#include <functional>
#include <mutex>
#include <ostream>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/mapping/vdb_format.hpp"

namespace eg::mapping {
namespace {

/// A grid of which only the tree and the active states are held. The values of each leaf are computed when it is
/// written.
template <typename Grid>
class StreamedGrid : public Grid {
 public:
  using Leaf = typename Grid::TreeType::LeafNodeType;

  StreamedGrid(typename Grid::ValueType background, std::function<void(Leaf&)> fill)
      : Grid(background), fill_(std::move(fill)) {}

  void add_leaf(const openvdb::Coord& origin, const typename Leaf::NodeMaskType& active) {
    auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), origin, this->background());
    leaf->setValueMask(active);
    this->tree().addLeaf(leaf.release());
  }

  void writeBuffers(std::ostream& out) const override {
    for (auto leaf = this->tree().cbeginLeaf(); leaf; ++leaf) {
      Leaf filled(leaf->origin(), this->background());
      filled.setValueMask(leaf->valueMask());
      fill_(filled);
      filled.writeBuffers(out, this->saveFloatAsHalf());
    }
  }

 private:
  std::function<void(Leaf&)> fill_;
};

/// OpenVDB's file format. Its own writer would look into the leaves for an index of their sizes (file_delayed_load,
/// which may be absent) before they have values.
class StreamedArchive : public openvdb::io::Archive {
 public:
  [[nodiscard]] Ptr copy() const override { return std::make_shared<StreamedArchive>(*this); }

  void stream(std::span<openvdb::GridBase* const> grids, std::ostream& out) const {
    writeHeader(out, /*seekable=*/false);
    openvdb::MetaMap().writeMeta(out);
    const auto count = static_cast<openvdb::Int32>(grids.size());
    out.write(reinterpret_cast<const char*>(&count), sizeof count);
    for (const openvdb::GridBase* const grid : grids) {
      const openvdb::io::GridDescriptor descriptor(grid->getName(), grid->type());
      descriptor.writeHeader(out);
      descriptor.writeStreamPos(out);  // none: it is for files in which one can seek
      setGridCompression(out, *grid);
      grid->writeMeta(out);
      grid->writeTransform(out);
      grid->writeTopology(out);
      grid->writeBuffers(out);
    }
  }
};

/// The sums of a map, tile by tile. OpenVDB's writer knows no results, so that failures are exceptions here.
class SumsReader {
 public:
  explicit SumsReader(TilePager& pager) : pager_(pager) {}

  LeafSums sums_at(const openvdb::Coord& origin) {
    bring_back(floor_divide(Eigen::Vector3i(origin.x(), origin.y(), origin.z()), kTileSide));
    return pager_.grids().probe(origin);
  }

  /// Calls `visit` with the origin of each leaf.
  void for_each_leaf(const std::function<void(const openvdb::Coord&)>& visit) {
    for (const Eigen::Vector3i& tile : pager_.tiles()) {
      bring_back(tile);
      const Eigen::Vector3i first = kTileSide * tile;
      for (int x = first.x(); x < first.x() + kTileSide; x += kLeafSide) {
        for (int y = first.y(); y < first.y() + kTileSide; y += kLeafSide) {
          for (int z = first.z(); z < first.z() + kTileSide; z += kLeafSide) {
            if (pager_.grids().weight.probeConstLeaf({x, y, z}) != nullptr) visit({x, y, z});
          }
        }
      }
    }
  }

 private:
  void bring_back(const Eigen::Vector3i& tile) {
    if (!pager_.is_away(tile)) return;
    check(pager_.bring_back({tile}));
    check(pager_.keep_budget());
  }

  static void check(const base::Status& status) {
    if (!status) throw std::runtime_error(status.error().message);
  }

  TilePager& pager_;
};

using WeightGrid = StreamedGrid<openvdb::Int32Grid>;
using DistanceGrid = StreamedGrid<openvdb::FloatGrid>;
using ColourGrid = StreamedGrid<openvdb::Vec3SGrid>;

openvdb::Vec3f mean_colour(const openvdb::Vec4i& sums) {
  const float scale = 1.0F / (kMaxColour * static_cast<float>(sums[3]));
  return {scale * static_cast<float>(sums[0]), scale * static_cast<float>(sums[1]),
          scale * static_cast<float>(sums[2])};
}

/// Calls `set` with the number of each active voxel.
template <typename Leaf, typename Set>
void fill_active(Leaf& leaf, const Set& set) {
  for (auto value = leaf.valueMask().beginOn(); value; ++value) leaf.setValueOnly(value.pos(), set(value.pos()));
}

void describe(openvdb::GridBase& grid, const char* name, const TsdfOptions& options, openvdb::GridClass grid_class) {
  grid.setName(name);
  grid.setTransform(openvdb::math::Transform::createLinearTransform(options.voxel_size));
  grid.setGridClass(grid_class);
}

void write_all(SumsReader& reader, const TsdfOptions& options, std::ostream& out) {
  const TsdfUnits units(options);
  const float step = units.metres_per_step();
  const auto distances = std::make_shared<DistanceGrid>(step * TsdfUnits::kTruncationSteps, [&](auto& leaf) {
    const LeafSums sums = reader.sums_at(leaf.origin());
    fill_active(leaf, [&](openvdb::Index voxel) {
      return step * (1.0F / static_cast<float>(sums.weight[voxel])) * static_cast<float>(sums.distance[voxel]);
    });
  });
  const auto weights = std::make_shared<WeightGrid>(0, [&](auto& leaf) {
    const LeafSums sums = reader.sums_at(leaf.origin());
    fill_active(leaf, [&](openvdb::Index voxel) { return sums.weight[voxel]; });
  });
  const auto colours = std::make_shared<ColourGrid>(openvdb::Vec3f(0.0F), [&](auto& leaf) {
    const LeafSums sums = reader.sums_at(leaf.origin());
    fill_active(leaf, [&](openvdb::Index voxel) { return mean_colour(sums.colour[voxel]); });
  });
  describe(*distances, kDistanceName, options, openvdb::GRID_LEVEL_SET);
  describe(*weights, kWeightName, options, openvdb::GRID_FOG_VOLUME);
  describe(*colours, kColourName, options, openvdb::GRID_UNKNOWN);

  reader.for_each_leaf([&](const openvdb::Coord& origin) {
    const LeafSums sums = reader.sums_at(origin);
    IntLeaf::NodeMaskType observed, coloured;
    for (openvdb::Index voxel = 0; voxel < IntLeaf::SIZE; ++voxel) {
      observed.set(voxel, sums.weight[voxel] != 0);
      coloured.set(voxel, sums.colour != nullptr && sums.colour[voxel][3] != 0);
    }
    distances->add_leaf(origin, observed);
    weights->add_leaf(origin, observed);
    if (sums.colour != nullptr) colours->add_leaf(origin, coloured);
  });
  const std::array<openvdb::GridBase*, 3> grids = {distances.get(), weights.get(), colours.get()};
  for (openvdb::GridBase* const grid : grids) {
    grid->addStatsMetadata();
    grid->removeMeta(openvdb::GridBase::META_FILE_MEM_BYTES);  // of a tree without values
  }
  StreamedArchive().stream(grids, out);
}

}  // namespace

void initialise_openvdb() {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
}

base::Status write_grids(TilePager& pager, const TsdfOptions& options, std::ostream& out) {
  initialise_openvdb();
  SumsReader reader(pager);
  try {
    write_all(reader, options, out);
  } catch (const std::exception& exception) {
    return base::fail(std::string("cannot write OpenVDB grids: ") + exception.what());
  }
  return out.good() ? base::Status{} : base::fail("cannot write OpenVDB grids: the stream failed");
}

}  // namespace eg::mapping
