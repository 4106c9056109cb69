#include <openvdb/io/Stream.h>

#include <cmath>
#include <istream>

#include "common/mapping/vdb_format.hpp"

namespace eg::mapping {
namespace {

template <typename Grid>
const Grid* find_grid(const openvdb::GridPtrVec& grids, const char* name) {
  for (const auto& grid : grids) {
    if (grid->getName() == name) return dynamic_cast<const Grid*>(grid.get());
  }
  return nullptr;
}

bool has_voxel_size(const openvdb::GridBase& grid, double voxel_size) {
  if (!grid.transform().isLinear()) return false;
  const openvdb::Vec3d origin = grid.transform().indexToWorld(openvdb::Vec3d(0.0));
  const openvdb::Vec3d diagonal = grid.transform().indexToWorld(openvdb::Vec3d(1.0));
  return origin.length() < 1e-9 && (diagonal - openvdb::Vec3d(voxel_size)).length() < 1e-9;
}

/// The sums of weight and distance of one voxel. False if they are nothing that write_grids() writes.
bool restore_distance(const TsdfUnits& units, std::int32_t weight, float distance, const LeafSums& sums,
                      openvdb::Index voxel) {
  const float steps = distance / units.metres_per_step();
  if (weight < 1 || weight > TsdfUnits::kFullWeight + TsdfUnits::kMaxWeight) return false;
  if (!(std::abs(steps) <= static_cast<float>(TsdfUnits::kTruncationSteps))) return false;
  sums.weight[voxel] = weight;
  sums.distance[voxel] = static_cast<std::int32_t>(std::lrint(static_cast<float>(weight) * steps));
  return true;
}

/// The same for the sums of colour.
bool restore_colour(std::int32_t weight, const openvdb::Vec3f& colour, openvdb::Vec4i& sums) {
  for (int i = 0; i < 3; ++i) {
    if (!(colour[i] >= 0.0F && colour[i] <= 1.0F)) return false;
    sums[i] = static_cast<std::int32_t>(std::lrint(static_cast<float>(weight) * kMaxColour * colour[i]));
  }
  sums[3] = weight;
  return true;
}

base::Result<openvdb::GridPtrVecPtr> read_stream(std::istream& in) {
  try {
    return openvdb::io::Stream(in, /*delayLoad=*/false).getGrids();
  } catch (const std::exception& exception) {
    return base::fail(std::string("not a readable OpenVDB file: ") + exception.what());
  }
}

}  // namespace

base::Status read_grids(std::istream& in, const TsdfOptions& options, TsdfGrids& grids) {
  initialise_openvdb();
  const auto file = read_stream(in);
  if (!file) return tl::make_unexpected(file.error());
  const auto* const distances = find_grid<openvdb::FloatGrid>(**file, kDistanceName);
  const auto* const weights = find_grid<openvdb::Int32Grid>(**file, kWeightName);
  const auto* const colours = find_grid<openvdb::Vec3SGrid>(**file, kColourName);
  if (distances == nullptr || weights == nullptr || colours == nullptr) {
    return base::fail("the OpenVDB file lacks one of the grids tsdf (float), weight (int32) and colour (vec3s)");
  }
  for (const openvdb::GridBase* grid :
       {static_cast<const openvdb::GridBase*>(distances), static_cast<const openvdb::GridBase*>(weights),
        static_cast<const openvdb::GridBase*>(colours)}) {
    if (!has_voxel_size(*grid, options.voxel_size)) {
      return base::fail("grid " + grid->getName() + " does not have voxels of " + std::to_string(options.voxel_size) +
                        " m");
    }
  }

  const TsdfUnits units(options);
  for (auto leaf = weights->tree().cbeginLeaf(); leaf; ++leaf) {
    const auto* const distance = distances->tree().probeConstLeaf(leaf->origin());
    const auto* const colour = colours->tree().probeConstLeaf(leaf->origin());
    if (distance == nullptr) return base::fail("the OpenVDB grids do not cover the same space");
    LooseLeaf loose(leaf->origin());
    const LeafSums sums = loose.sums();
    auto colour_sums = colour != nullptr ? std::make_unique<ColourLeaf>(leaf->origin(), openvdb::Vec4i(0)) : nullptr;
    for (auto value = leaf->cbeginValueOn(); value; ++value) {
      const openvdb::Index voxel = value.pos();
      const bool has_colour = colour != nullptr && colour->isValueOn(voxel);
      if (!restore_distance(units, *value, distance->getValue(voxel), sums, voxel) ||
          (has_colour && !restore_colour(*value, colour->getValue(voxel), colour_sums->buffer().data()[voxel]))) {
        return base::fail("a voxel of the OpenVDB grids is out of range");
      }
    }
    if (colour_sums) grids.colour.addLeaf(colour_sums.release());
    grids.insert(std::move(loose));
  }
  return {};
}

}  // namespace eg::mapping
