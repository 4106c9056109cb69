#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace eg::mapping {

/// Corner c of a cell is its lowest corner plus (c & 1, c >> 1 & 1, c >> 2 & 1).
inline constexpr int kCubeCorners = 8;
inline constexpr int kCubeEdges = 12;

/// Edge between two corners along `axis` (0, 1, 2 for x, y, z); `low` is the corner with the lower coordinate.
struct CubeEdge {
  std::uint8_t low = 0;
  std::uint8_t high = 0;
  std::uint8_t axis = 0;
};

const std::array<CubeEdge, kCubeEdges>& cube_edges();

/// Triangles of a cell, as numbers of the edges that their corners lie on, counter-clockwise seen from the positive
/// side.
using CubeTriangles = std::vector<std::array<std::uint8_t, 3>>;

/// Marching cubes (Lorensen and Cline, SIGGRAPH 1987). `negative_corners`: bit c is set when the field is negative at
/// corner c. The table is derived, not typed: on every face each run of negative corners is cut off by a line of its
/// own, which depends on the face alone, so neighbouring cells agree and the surface has no cracks (the flaw of the
/// original table); the lines of a cell's six faces close into polygons, which are cut into triangles without using a
/// face's diagonal, so that no edge has more than two triangles.
const CubeTriangles& cube_triangles(std::uint8_t negative_corners);

}  // namespace eg::mapping
