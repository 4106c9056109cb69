#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "common/base/result.hpp"

namespace eg::services {

struct PageFile {
  std::string content_type;
  std::string bytes;
};

/// The files of the page by the path that a browser asks for ("/", "/main.js"). They are read once: what is not in this
/// table does not exist for a browser, however it spells a path.
using PageFiles = std::map<std::string, PageFile, std::less<>>;

/// All files of the folder, without folders in it. An error names what cannot be read; index.html must be there.
base::Result<PageFiles> load_page(const std::filesystem::path& folder);

}  // namespace eg::services
