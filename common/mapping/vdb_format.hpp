#pragma once

#include <iosfwd>
#include <memory>

#include "common/base/result.hpp"
#include "common/mapping/tsdf_grids.hpp"

namespace eg::mapping {

/// The sums as means in three OpenVDB grids, and back. See TsdfMap::write_vdb and TsdfMap::read_vdb.
base::Status write_grids(const TsdfGrids& grids, const TsdfOptions& options, std::ostream& out);
base::Result<std::unique_ptr<TsdfGrids>> read_grids(std::istream& in, const TsdfOptions& options);

}  // namespace eg::mapping
