#include "services/viewer/page_files.hpp"

#include <spdlog/fmt/fmt.h>

#include <fstream>
#include <system_error>

#include "common/base/read_stream.hpp"

namespace eg::services {
namespace {

std::string content_type_of(const std::filesystem::path& file) {
  static const std::map<std::string, std::string> kTypes = {{".html", "text/html; charset=utf-8"},
                                                            {".css", "text/css; charset=utf-8"},
                                                            {".js", "text/javascript; charset=utf-8"},
                                                            {".svg", "image/svg+xml"}};
  const auto known = kTypes.find(file.extension().string());
  return known == kTypes.end() ? "application/octet-stream" : known->second;
}

}  // namespace

base::Result<PageFiles> load_page(const std::filesystem::path& folder) {
  std::error_code failure;
  PageFiles files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    std::string bytes = base::read_stream(stream);
    if (!stream.is_open() || stream.bad()) return base::fail("cannot read " + entry.path().string());
    files[fmt::format("/{}", entry.path().filename().string())] = {content_type_of(entry.path()), std::move(bytes)};
  }
  if (failure) return base::fail("cannot read the page's folder " + folder.string() + ": " + failure.message());
  const auto index = files.find("/index.html");
  if (index == files.end()) return base::fail("there is no index.html in " + folder.string());
  files["/"] = index->second;
  return files;
}

}  // namespace eg::services
