#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/io/journal.hpp"
#include "common/messages/codec.hpp"

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

/// Records of archives hold messages.
inline std::string_view text_of(const messages::Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
inline messages::ByteView bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Stands for the types of messages that the records of a file hold, in its header.
template <typename... Messages>
std::uint64_t schema_of() {
  const auto fingerprint = [](const messages::Bytes& message) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof value; ++i) value = value << 8U | message[i];
    return value;
  };
  return (fingerprint(messages::encode(Messages{})) ^ ...);
}

}  // namespace eg::service
