#include "common/mapping/marching_cubes.hpp"

#include <cstddef>
#include <optional>
#include <utility>

#include "common/base/check.hpp"

namespace eg::mapping {
namespace {

using Polygon = std::vector<std::uint8_t>;  // numbers of edges

/// Corners of the six faces, counter-clockwise seen from outside the cube.
constexpr std::uint8_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

std::array<CubeEdge, kCubeEdges> make_edges() {
  std::array<CubeEdge, kCubeEdges> edges;
  std::size_t count = 0;
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    for (std::uint8_t corner = 0; corner < kCubeCorners; ++corner) {
      const auto bit = static_cast<std::uint8_t>(1 << axis);
      if ((corner & bit) == 0) edges[count++] = {corner, static_cast<std::uint8_t>(corner | bit), axis};
    }
  }
  return edges;
}

std::uint8_t edge_between(std::uint8_t a, std::uint8_t b) {
  const auto& edges = cube_edges();
  for (std::uint8_t e = 0; e < kCubeEdges; ++e) {
    if ((edges[e].low == a && edges[e].high == b) || (edges[e].low == b && edges[e].high == a)) return e;
  }
  base::check_failed("edge_between", "corners are not neighbours", __FILE__, __LINE__);
}

/// Bit f is set when face f contains the edge.
std::uint8_t faces_of_edge(std::uint8_t edge) {
  const CubeEdge& e = cube_edges()[edge];
  int faces = 0;
  for (int f = 0; f < 6; ++f) {
    int found = 0;
    for (const std::uint8_t corner : kFaces[f]) found += corner == e.low || corner == e.high;
    if (found == 2) faces |= 1 << f;
  }
  return static_cast<std::uint8_t>(faces);
}

/// For every cut edge the next one along the surface's outline. Walking round a face counter-clockwise, the line goes
/// from the edge where a run of negative corners begins to the edge where it ends; the neighbouring face walks along
/// the shared edge the other way, so there the same edge begins a line.
std::array<std::uint8_t, kCubeEdges> trace_faces(std::uint8_t negative) {
  const auto is_negative = [&](std::uint8_t corner) { return (negative >> corner & 1) != 0; };
  std::array<std::uint8_t, kCubeEdges> next;
  next.fill(kCubeEdges);
  for (const auto& face : kFaces) {
    for (int i = 0; i < 4; ++i) {
      if (is_negative(face[i]) || !is_negative(face[(i + 1) % 4])) continue;
      int end = i + 1;
      while (is_negative(face[(end + 1) % 4])) ++end;
      next[edge_between(face[i], face[(i + 1) % 4])] = edge_between(face[end % 4], face[(end + 1) % 4]);
    }
  }
  return next;
}

std::vector<Polygon> trace_polygons(std::uint8_t negative) {
  auto next = trace_faces(negative);
  std::vector<Polygon> polygons;
  for (std::uint8_t start = 0; start < kCubeEdges; ++start) {
    if (next[start] == kCubeEdges) continue;
    Polygon& polygon = polygons.emplace_back();
    for (std::uint8_t edge = start; next[edge] != kCubeEdges;) {
      polygon.push_back(edge);
      edge = std::exchange(next[edge], static_cast<std::uint8_t>(kCubeEdges));
    }
  }
  return polygons;
}

/// Cuts ears off until a triangle is left. A diagonal between two edges of one face would lie in that face, where the
/// neighbouring cell may draw the same one: such ears are not cut. No result if the polygon cannot be cut that way.
std::optional<CubeTriangles> cut_polygon(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  if (n == 3) return CubeTriangles{{polygon[0], polygon[1], polygon[2]}};
  for (std::size_t ear = 0; ear < n; ++ear) {
    const std::uint8_t before = polygon[(ear + n - 1) % n];
    const std::uint8_t after = polygon[(ear + 1) % n];
    if ((faces_of_edge(before) & faces_of_edge(after)) != 0) continue;
    Polygon rest = polygon;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(ear));
    if (auto triangles = cut_polygon(rest)) {
      triangles->push_back({before, polygon[ear], after});
      return triangles;
    }
  }
  return std::nullopt;
}

std::array<CubeTriangles, 256> make_table() {
  std::array<CubeTriangles, 256> table;
  for (std::size_t negative = 0; negative < table.size(); ++negative) {
    for (const Polygon& polygon : trace_polygons(static_cast<std::uint8_t>(negative))) {
      const auto triangles = cut_polygon(polygon);
      EG_CHECK(triangles, "every polygon of a cell can be cut without face diagonals");
      table[negative].insert(table[negative].end(), triangles->begin(), triangles->end());
    }
  }
  return table;
}

}  // namespace

const std::array<CubeEdge, kCubeEdges>& cube_edges() {
  static const std::array<CubeEdge, kCubeEdges> edges = make_edges();
  return edges;
}

const CubeTriangles& cube_triangles(std::uint8_t negative_corners) {
  static const std::array<CubeTriangles, 256> table = make_table();
  return table[negative_corners];
}

}  // namespace eg::mapping
