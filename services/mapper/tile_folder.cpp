#include "services/mapper/tile_folder.hpp"

#include <spdlog/spdlog.h>

#include <system_error>
#include <utility>

#include "common/io/journal.hpp"

namespace eg::services {
namespace {

constexpr std::uint64_t kSchema = 0x454c4954;  // "TILE"; the process that wrote a file is the only one to read it

}  // namespace

base::Result<std::shared_ptr<TileFolder>> TileFolder::open(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::remove_all(folder, failure);
  if (!failure) std::filesystem::create_directory(folder, failure);
  if (failure) return base::fail(folder.string() + ": cannot be made anew: " + failure.message());
  return std::shared_ptr<TileFolder>(new TileFolder(folder));
}

TileFolder::~TileFolder() {
  std::error_code failure;
  std::filesystem::remove_all(folder_, failure);
  if (failure) spdlog::warn("{}: cannot be removed: {}", folder_.string(), failure.message());
}

std::filesystem::path TileFolder::file_of(const Eigen::Vector3i& tile) const {
  return folder_ / (std::to_string(tile.x()) + "_" + std::to_string(tile.y()) + "_" + std::to_string(tile.z()));
}

base::Status TileFolder::put(const Eigen::Vector3i& tile, std::string_view bytes) {
  return io::write_journal(file_of(tile), kSchema, [&](const auto& add) -> base::Status {
    add({0, bytes});
    return {};
  });
}

base::Result<std::string> TileFolder::get(const Eigen::Vector3i& tile) {
  std::string bytes;
  const auto read = io::read_journal(file_of(tile), kSchema, [&](const io::JournalRecord& record) -> base::Status {
    bytes = record.bytes;
    return {};
  });
  if (!read) return tl::make_unexpected(read.error());
  if (bytes.empty()) return base::fail(file_of(tile).string() + ": is cut short");
  return bytes;
}

}  // namespace eg::services
