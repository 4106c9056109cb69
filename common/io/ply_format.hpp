#pragma once

#include <cstddef>
#include <string>

#include "common/io/ply.hpp"

namespace eg::io {

/// What a PLY file's header tells.
struct PlyCounts {
  std::size_t vertices = 0;
  bool normals = false;
  bool colours = false;
  std::size_t triangles = 0;
  std::size_t edges = 0;
};
PlyCounts counts_of(const PlyView& data);

std::string ply_header(const PlyCounts& counts);
void append_ply_vertices(const PlyView& data, std::string& bytes);
void append_ply_triangles(const PlyView& data, std::string& bytes);

std::string pcd_header(const PlyCounts& counts);
void append_pcd_points(const PlyView& cloud, std::string& bytes);

template <typename T>
void append_numbers(const T* values, std::size_t count, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

}  // namespace eg::io
