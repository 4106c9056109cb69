#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/synthetic/scene.hpp"

namespace eg::synthetic {

/// The light that falls on one surface, on a lattice over its bounds: bilinear between the nodes.
class LightMap {
 public:
  LightMap(const Eigen::Vector2d& extent, double spacing);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] Eigen::Vector2d node(int column, int row) const;
  float& at(int column, int row) { return values_[static_cast<std::size_t>(row * columns_ + column)]; }

  /// Irradiance at a position on the surface (metres), 1: a well-lit white wall.
  [[nodiscard]] float sample(const Eigen::Vector2f& uv) const;

 private:
  int columns_ = 2;
  int rows_ = 2;
  Eigen::Vector2f pitch_;
  std::vector<float> values_;
};

/// Light for every surface: that of the lamps with soft shadows, and light from all sides weakened where other surfaces
/// are near (ambient obscurance: Zhukov, Iones, Kronin, Rendering Techniques 1998). One map per surface; runs in
/// parallel.
std::vector<LightMap> bake_lighting(const Scene& scene);

}  // namespace eg::synthetic
