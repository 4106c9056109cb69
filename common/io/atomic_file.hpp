#pragma once

#include <filesystem>
#include <string_view>

#include "common/base/result.hpp"

namespace eg::io {

/// What a written file outlives.
enum class Durability {
  process,  ///< the end of the process, however it comes
  machine,  ///< a loss of power too; waits for the disk
};

/// Writes a file whole or not at all: the bytes go into a temporary file in the same folder, which is then renamed, so
/// that a reader, a crash or a full disk never leaves half a file under `path`. The error names the path and says why.
base::Status write_file_atomically(const std::filesystem::path& path, std::string_view bytes,
                                   Durability durability = Durability::process);

}  // namespace eg::io
