#pragma once

#include <filesystem>
#include <memory>

#include "common/mapping/tile_store.hpp"

namespace eg::services {

/// Tiles of a map that are not in memory, as files with checksums. They mean nothing to anybody else: what an earlier
/// mapper left in the folder is removed when it is opened, and the folder when the map is gone.
class TileFolder : public mapping::TileStore {
 public:
  static base::Result<std::shared_ptr<TileFolder>> open(const std::filesystem::path& folder);
  ~TileFolder() override;

  base::Status put(const Eigen::Vector3i& tile, std::string_view bytes) override;
  base::Result<std::string> get(const Eigen::Vector3i& tile) override;

 private:
  explicit TileFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  [[nodiscard]] std::filesystem::path file_of(const Eigen::Vector3i& tile) const;

  std::filesystem::path folder_;
};

}  // namespace eg::services
