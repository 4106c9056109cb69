#include "common/mapping/tile_mesher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/mapping/marching_cubes.hpp"

namespace eg::mapping {
namespace {

// A vertex on a corner would be shared by all edges there, and triangles between them would have no area.
constexpr float kMinFraction = 0.02F;
constexpr float kGrey = 127.0F;
constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

int corner_offset(int corner) { return TileBlock::index(corner & 1, corner >> 1 & 1, corner >> 2 & 1); }

/// Number of an edge of the whole grid: 20 bits of each coordinate of its lower voxel, and the axis.
std::uint64_t edge_key(const Eigen::Vector3i& voxel, int axis) {
  std::uint64_t key = 0;
  for (int i = 0; i < 3; ++i) key = key << 20 | (static_cast<std::uint64_t>(voxel[i]) & 0xfffffU);
  return key << 2 | static_cast<std::uint64_t>(axis);
}

class Mesher {
 public:
  Mesher(const TileBlock& block, double voxel_size, double max_step)
      : block_(block),
        voxel_size_(voxel_size),
        max_step_(static_cast<float>(max_step)),
        vertex_of_edge_(3 * block.distance.size(), kNoVertex) {}

  TileMesh run() && {
    for (int x = 1; x <= kTileSide; ++x) {
      for (int y = 1; y <= kTileSide; ++y) {
        for (int z = 1; z <= kTileSide; ++z) mesh_cell({x, y, z});
      }
    }
    return std::move(result_);
  }

 private:
  void mesh_cell(const Eigen::Vector3i& cell) {
    const int base = TileBlock::index(cell.x(), cell.y(), cell.z());
    int negative = 0;
    for (int corner = 0; corner < kCubeCorners; ++corner) {
      const float distance = block_.distance[static_cast<std::size_t>(base + corner_offset(corner))];
      if (std::isnan(distance)) return;
      negative |= static_cast<int>(distance < 0.0F) << corner;
    }
    const CubeTriangles& triangles = cube_triangles(static_cast<std::uint8_t>(negative));
    if (triangles.empty() || has_jump(base, negative)) return;
    for (const auto& triangle : triangles) {
      auto& corners = result_.mesh.triangles.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) corners[i] = vertex_on_edge(cell, cube_edges()[triangle[i]]);
    }
  }

  [[nodiscard]] bool has_jump(int base, int negative) const {
    return std::any_of(cube_edges().begin(), cube_edges().end(), [&](const CubeEdge& edge) {
      const bool is_cut = ((negative >> edge.low ^ negative >> edge.high) & 1) != 0;
      return is_cut && std::abs(distance_at(base + corner_offset(edge.low)) -
                                distance_at(base + corner_offset(edge.high))) > max_step_;
    });
  }

  std::uint32_t vertex_on_edge(const Eigen::Vector3i& cell, const CubeEdge& edge) {
    const Eigen::Vector3i low = cell + Eigen::Vector3i(edge.low & 1, edge.low >> 1 & 1, edge.low >> 2 & 1);
    const int index = TileBlock::index(low.x(), low.y(), low.z());
    std::uint32_t& vertex = vertex_of_edge_[static_cast<std::size_t>(3 * index + edge.axis)];
    if (vertex == kNoVertex) {
      vertex = static_cast<std::uint32_t>(result_.mesh.vertices.size());
      add_vertex(low, index, edge.axis);
    }
    return vertex;
  }

  void add_vertex(const Eigen::Vector3i& low, int index, int axis) {
    const int other = index + TileBlock::kStride[axis];
    const float from = distance_at(index);
    const float to = distance_at(other);
    const float fraction = std::clamp(from / (from - to), kMinFraction, 1.0F - kMinFraction);

    const Eigen::Vector3i voxel = block_.first_voxel + low;
    Eigen::Vector3d position = voxel.cast<double>();
    position[axis] += fraction;
    Eigen::Vector3f gradient;
    for (int i = 0; i < 3; ++i) {
      gradient[i] = i == axis ? to - from : (1.0F - fraction) * slope(index, i) + fraction * slope(other, i);
    }
    const Eigen::Vector3f colour = colour_between(index, other, fraction);

    Mesh& mesh = result_.mesh;
    mesh.vertices.push_back((voxel_size_ * position).cast<float>());
    mesh.normals.push_back(gradient.normalized());
    mesh.colours.push_back({to_byte(colour[0]), to_byte(colour[1]), to_byte(colour[2])});
    if (is_on_border(low, axis)) {
      result_.border.push_back({edge_key(voxel, axis), static_cast<std::uint32_t>(mesh.vertices.size() - 1)});
    }
  }

  /// Derivative along an axis at a voxel, in metres per voxel: central where both neighbours are observed, else
  /// one-sided.
  [[nodiscard]] float slope(int index, int axis) const {
    const float here = distance_at(index);
    const float before = distance_at(index - TileBlock::kStride[axis]);
    const float after = distance_at(index + TileBlock::kStride[axis]);
    if (std::isnan(before)) return std::isnan(after) ? 0.0F : after - here;
    return std::isnan(after) ? here - before : 0.5F * (after - before);
  }

  /// What is not known at one of the two voxels is taken from the other; known at neither, it is a medium grey.
  [[nodiscard]] Eigen::Vector3f colour_between(int index, int other, float fraction) const {
    const Eigen::Vector3f& from = colour_at(index);
    const Eigen::Vector3f& to = colour_at(other);
    if (from.hasNaN()) return to.hasNaN() ? Eigen::Vector3f::Constant(kGrey) : to;
    if (to.hasNaN()) return from;
    return (1.0F - fraction) * from + fraction * to;
  }

  static bool is_on_border(const Eigen::Vector3i& low, int axis) {
    for (int i = 0; i < 3; ++i) {
      if (i != axis && (low[i] == 1 || low[i] == kTileSide + 1)) return true;
    }
    return false;
  }

  static std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F) + 0.5F); }

  [[nodiscard]] float distance_at(int index) const { return block_.distance[static_cast<std::size_t>(index)]; }
  [[nodiscard]] const Eigen::Vector3f& colour_at(int index) const {
    return block_.colour[static_cast<std::size_t>(index)];
  }

  const TileBlock& block_;
  double voxel_size_;
  float max_step_;
  std::vector<std::uint32_t> vertex_of_edge_;
  TileMesh result_;
};

}  // namespace

TileBlock::TileBlock(const Eigen::Vector3i& tile)
    : first_voxel(kTileSide * tile - Eigen::Vector3i::Ones()),
      distance(static_cast<std::size_t>(kSide) * kSide * kSide, std::numeric_limits<float>::quiet_NaN()),
      colour(distance.size(), Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN())) {}

TileMesh mesh_tile(const TileBlock& block, double voxel_size, double max_step) {
  return Mesher(block, voxel_size, max_step).run();
}

}  // namespace eg::mapping
