#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "common/base/result.hpp"

namespace eg::mapping {

/// Where the packed tiles of one map go that its memory has no room for.
class TileStore {
 public:
  TileStore() = default;
  TileStore(const TileStore&) = delete;
  TileStore& operator=(const TileStore&) = delete;
  virtual ~TileStore() = default;

  /// Keeps the bytes under the tile's number in the place of any before; what was there stays if it fails.
  virtual base::Status put(const Eigen::Vector3i& tile, std::string_view bytes) = 0;

  /// What was last put under the number. The error names the place and says what is wrong with it.
  virtual base::Result<std::string> get(const Eigen::Vector3i& tile) = 0;
};

}  // namespace eg::mapping
