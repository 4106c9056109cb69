#pragma once

#include <filesystem>
#include <string_view>

#include "common/base/result.hpp"

namespace eg::io {

/// Writes a file whole or not at all: the bytes go into a temporary file in the same folder, which is then renamed, so
/// that a reader, a crash or a full disk never leaves half a file under `path`. The error names the path and says why.
base::Status write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace eg::io
