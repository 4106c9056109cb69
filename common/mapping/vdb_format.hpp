#pragma once

#include <iosfwd>

#include "common/base/result.hpp"
#include "common/mapping/tile_pager.hpp"
#include "common/mapping/tsdf_options.hpp"

namespace eg::mapping {

// Names of the grids in the file.
inline constexpr char kDistanceName[] = "tsdf";
inline constexpr char kWeightName[] = "weight";
inline constexpr char kColourName[] = "colour";
inline constexpr float kMaxColour = 255.0F;

/// Makes OpenVDB's types known to its reader and writer.
void initialise_openvdb();

/// The sums as means in three OpenVDB grids. Only the blocks' places are held for it; their voxels are made one block
/// after the other. See TsdfMap::write_vdb.
base::Status write_grids(TilePager& pager, const TsdfOptions& options, std::ostream& out);

/// And back, into grids that are empty so far; in part if it fails. See TsdfMap::read_vdb.
base::Status read_grids(std::istream& in, const TsdfOptions& options, TsdfGrids& grids);

}  // namespace eg::mapping
