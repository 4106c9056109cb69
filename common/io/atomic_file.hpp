#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string_view>

#include "common/base/result.hpp"

namespace eg::io {

/// What a written file outlives.
enum class Durability {
  process,  ///< the end of the process, however it comes
  machine,  ///< a loss of power too; waits for the disk
};

/// Whether files can be made in a folder, which is there. The error names it and says why not.
base::Status check_writable(const std::filesystem::path& folder);

/// Writes a file whole or not at all: the bytes go into a temporary file in the same folder, which is then renamed, so
/// that a reader, a crash or a full disk never leaves half a file under `path`. The error names the path and says why.
base::Status write_file_atomically(const std::filesystem::path& path, std::string_view bytes,
                                   Durability durability = Durability::process);

/// The same for what is too large to be held twice: `write` gets a stream. Its error is passed on.
base::Status write_file_atomically(const std::filesystem::path& path,
                                   const std::function<base::Status(std::ostream&)>& write);

}  // namespace eg::io
