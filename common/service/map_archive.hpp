#pragma once

#include <filesystem>
#include <string>

#include "common/io/journal.hpp"
#include "common/service/message_records.hpp"

/// The map archive: the folder map/ in a run's results, from which a later session goes on. The tracker keeps the
/// sparse map and its replica of the E-Graph in sparse.map, every mapper its grids and keyframe images in dense.map
/// (dense.I.map). Each file is a journal (common/io/journal.hpp): versioned, every record with a checksum, replaced
/// whole or not at all.
namespace eg::service {

/// Where a run that wrote to `out` keeps its archive.
inline std::filesystem::path archive_folder(const std::filesystem::path& out) { return out / "map"; }

inline constexpr char kSparseMapFile[] = "sparse.map";
inline constexpr char kDenseMapName[] = "dense";  ///< with a mapper's share behind it, and .map

/// The file named in an archive that is given as the folder itself or as the results that it lies in.
inline std::filesystem::path file_in_archive(const std::filesystem::path& given, const std::string& name) {
  const std::filesystem::path inside = archive_folder(given) / name;
  return std::filesystem::exists(inside) ? inside : given / name;
}

}  // namespace eg::service
