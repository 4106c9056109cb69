#include "services/mapper/map_files.hpp"

#include <ostream>
#include <system_error>

#include "common/io/atomic_file.hpp"
#include "common/io/mesh_files.hpp"
#include "common/service/map_archive.hpp"
#include "services/mapper/dense_archive.hpp"
#include "services/mapper/tile_folder.hpp"

namespace eg::services {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMegabyte = 1'000'000;

std::string archive_file(const mapping::TsdfOptions& options) {
  return with_share(service::kDenseMapName, options) + ".map";
}

base::Status write_mesh(const fs::path& stem, const mapping::TsdfMap& field) {
  auto files = io::MeshFiles::create(stem);
  if (!files) return tl::make_unexpected(files.error());
  const auto written = field.extract_mesh([&](const mapping::Mesh& piece) { return files->add(piece); });
  return written ? files->finish() : written;
}

base::Status write_archive(const fs::path& out, const KeyframeMap& map) {
  const fs::path folder = service::archive_folder(out);
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) return base::fail(folder.string() + ": cannot be made: " + failure.message());
  return save_dense_archive(folder / archive_file(map.field().options()), map);
}

}  // namespace

std::string with_share(const std::string& name, const mapping::TsdfOptions& options) {
  return options.shares == 1 ? name : name + "." + std::to_string(options.share);
}

base::Status limit_memory(const fs::path& out, const MapperOptions& options, KeyframeMap& map) {
  if (out.empty() || options.memory_mb == 0) return {};
  auto folder = TileFolder::open(out / with_share("mapper", options.tsdf).append(".tiles"));
  if (!folder) return tl::make_unexpected(folder.error());
  map.field().limit_memory(options.memory_mb * kMegabyte, *std::move(folder));
  return {};
}

base::Status load_map(const fs::path& archive, KeyframeMap& map) {
  return load_dense_archive(service::file_in_archive(archive, archive_file(map.field().options())), map);
}

base::Status save_map(const fs::path& out, KeyframeMap& map) {
  if (auto settled = map.settle(); !settled) return settled;
  const std::string name = with_share("mesh", map.field().options());
  if (auto mesh = write_mesh(out / name, map.field()); !mesh) return mesh;
  const auto vdb =
      io::write_file_atomically(out / (name + ".vdb"), [&](std::ostream& file) { return map.field().write_vdb(file); });
  return vdb ? write_archive(out, map) : vdb;
}

}  // namespace eg::services
