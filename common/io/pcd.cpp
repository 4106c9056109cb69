#include "common/io/pcd.hpp"

#include <bit>

#include "common/base/check.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/ply_format.hpp"

namespace eg::io {
namespace {

static_assert(std::endian::native == std::endian::little, "PCD files are written as the machine stores numbers");

/// Names, sizes, types and counts of the fields, line by line.
struct Fields {
  std::string names = "FIELDS x y z";
  std::string sizes = "SIZE 4 4 4";
  std::string types = "TYPE F F F";
  std::string counts = "COUNT 1 1 1";

  void add(const char* name) {
    names.append(" ").append(name);
    sizes += " 4";
    types += " F";
    counts += " 1";
  }
};

}  // namespace

std::string pcd_header(const PlyCounts& counts) {
  Fields fields;
  if (counts.normals) {
    for (const char* name : {"normal_x", "normal_y", "normal_z"}) fields.add(name);
  }
  if (counts.colours) fields.add("rgb");
  const std::string count = std::to_string(counts.vertices);
  std::string header = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n";
  for (const std::string& line : {fields.names, fields.sizes, fields.types, fields.counts}) header.append(line) += '\n';
  header.append("WIDTH ").append(count).append("\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS ").append(count);
  return header.append("\nDATA binary\n");
}

void append_pcd_points(const PlyView& cloud, std::string& bytes) {
  const std::size_t count = cloud.vertices.size();
  EG_CHECK(cloud.normals.empty() || cloud.normals.size() == count, "a cloud has one normal per point or none");
  EG_CHECK(cloud.colours.empty() || cloud.colours.size() == count, "a cloud has one colour per point or none");
  constexpr std::size_t kPointBytes = 28;
  bytes.reserve(bytes.size() + kPointBytes * count);
  for (std::size_t i = 0; i < count; ++i) {
    append_numbers(cloud.vertices[i].data(), 3, bytes);
    if (!cloud.normals.empty()) append_numbers(cloud.normals[i].data(), 3, bytes);
    if (cloud.colours.empty()) continue;
    const auto& [red, green, blue] = cloud.colours[i];
    const std::uint32_t rgb = std::uint32_t{red} << 16U | std::uint32_t{green} << 8U | std::uint32_t{blue};
    append_numbers(&rgb, 1, bytes);
  }
}

std::string format_pcd(const PlyView& cloud) {
  std::string bytes = pcd_header(counts_of(cloud));
  append_pcd_points(cloud, bytes);
  return bytes;
}

base::Status write_pcd(const std::filesystem::path& path, const PlyView& cloud) {
  return write_file_atomically(path, format_pcd(cloud));
}

}  // namespace eg::io
