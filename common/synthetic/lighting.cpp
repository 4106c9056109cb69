#include "common/synthetic/lighting.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace eg::synthetic {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSpacing = 0.12;   // metres between nodes
constexpr double kReach = 1.2;      // metres within which a surface takes ambient light away
constexpr double kSmallest = 0.02;  // m²: surfaces below cast no shadow worth its time
constexpr int kRings = 4;           // ambient directions: rings x sectors
constexpr int kSectors = 8;
constexpr int kLampSamples = 2;  // per axis

/// A surface that casts shadows.
struct Occluder {
  const Surface* surface;
  geometry::Plane plane;
  Vector3d centre;  ///< of its bounds
  double radius;
};
using Occluders = std::vector<Occluder>;

Occluders all_occluders(const Scene& scene) {
  Occluders occluders;
  for (const Surface& surface : scene.surfaces) {
    if (surface.area() < kSmallest || surface.material.glow > 0) continue;
    const Eigen::AlignedBox2d box = surface.bounds();
    occluders.push_back({&surface, surface.plane(), surface.point(box.center()), 0.5 * box.diagonal().norm()});
  }
  return occluders;
}

/// Those that something within `reach` of the point and in front of `plane` can touch.
Occluders occluders_near(const Occluders& all, const geometry::Plane& plane, const Vector3d& point, double reach) {
  Occluders near;
  std::copy_if(all.begin(), all.end(), std::back_inserter(near), [&](const Occluder& o) {
    return (o.centre - point).norm() < o.radius + reach && plane.signed_distance(o.centre) > -o.radius &&
           std::abs(o.plane.signed_distance(point)) < reach;
  });
  return near;
}

/// Distance along the unit `direction` to the first of the occluders, at most `reach`.
double free_distance(const Occluders& occluders, const Vector3d& from, const Vector3d& direction, double reach) {
  for (const Occluder& occluder : occluders) {
    const double approach = -occluder.plane.normal.dot(direction);
    if (approach <= 0.0) continue;
    const double height = occluder.plane.signed_distance(from);
    if (height <= 0.0 || height >= reach * approach) continue;
    const double distance = height / approach;
    if (occluder.surface->contains(occluder.surface->uv(from + distance * direction))) reach = distance;
  }
  return reach;
}

/// Directions over the hemisphere about +z, as dense as the cosine, so that their plain mean is the irradiance.
std::vector<Vector3d> cosine_directions() {
  std::vector<Vector3d> directions;
  for (int ring = 0; ring < kRings; ++ring) {
    const double radius = std::sqrt((ring + 0.5) / kRings);
    for (int sector = 0; sector < kSectors; ++sector) {
      const double angle = 2.0 * std::numbers::pi * (sector + 0.5 * (ring % 2)) / kSectors;
      directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1.0 - radius * radius));
    }
  }
  return directions;
}

double ambient_light(const Occluders& occluders, const Surface& surface, const Vector3d& point) {
  static const std::vector<Vector3d> directions = cosine_directions();
  Eigen::Matrix3d world_from_surface;
  world_from_surface << surface.axis_u, surface.axis_v, surface.normal();
  const Occluders near = occluders_near(occluders, surface.plane(), point, kReach);
  double sum = 0.0;
  for (const Vector3d& direction : directions) {
    sum += free_distance(near, point, world_from_surface * direction, kReach) / kReach;
  }
  return sum / static_cast<double>(directions.size());
}

double lamp_light(const Occluders& occluders, const Lamp& lamp, const Surface& surface, const Vector3d& point) {
  double sum = 0.0;
  for (int i = 0; i < kLampSamples * kLampSamples; ++i) {
    const double x = 2.0 * (i % kLampSamples + 0.5) / kLampSamples - 1.0;
    const double y = 2.0 * (i / kLampSamples + 0.5) / kLampSamples - 1.0;
    const Vector3d to_lamp = lamp.centre + lamp.half_size * Vector3d(x, y, 0.0) - point;
    const double distance = to_lamp.norm();
    const Vector3d direction = to_lamp / distance;
    const double received = surface.normal().dot(direction);
    const double sent = direction.z();
    if (received <= 0.0 || sent <= 0.0) continue;
    if (free_distance(occluders, point, direction, distance) < distance) continue;
    // A softened inverse square, so that nothing near a lamp burns out.
    sum += received * (0.3 + 0.7 * sent) / (0.6 + 0.35 * distance * distance);
  }
  return lamp.power * sum / (kLampSamples * kLampSamples);
}

/// A place on the surface next to a node, drawn inwards a little: borders touch other surfaces.
Vector3d place_of(const Surface& surface, const Vector2d& node) {
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& corner : surface.outline) middle += corner / static_cast<double>(surface.outline.size());
  Vector2d uv = node;
  for (int step = 0; step < 40 && !surface.contains(uv, -0.004); ++step) uv += 0.05 * (middle - uv);
  return surface.point(uv) + 1e-3 * surface.normal();
}

}  // namespace

LightMap::LightMap(const Vector2d& extent, double spacing)
    : columns_(1 + std::max(1, static_cast<int>(std::ceil(extent.x() / spacing)))),
      rows_(1 + std::max(1, static_cast<int>(std::ceil(extent.y() / spacing)))),
      pitch_(static_cast<float>(extent.x() / (columns_ - 1)), static_cast<float>(extent.y() / (rows_ - 1))),
      values_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

Vector2d LightMap::node(int column, int row) const { return Vector2d(column, row).cwiseProduct(pitch_.cast<double>()); }

float LightMap::sample(const Eigen::Vector2f& uv) const {
  const float x = std::clamp(uv.x() / pitch_.x(), 0.0F, static_cast<float>(columns_ - 1));
  const float y = std::clamp(uv.y() / pitch_.y(), 0.0F, static_cast<float>(rows_ - 1));
  const int column = std::min(static_cast<int>(x), columns_ - 2);
  const int row = std::min(static_cast<int>(y), rows_ - 2);
  const float* node = values_.data() + row * columns_ + column;
  const float sx = x - static_cast<float>(column);
  const float sy = y - static_cast<float>(row);
  const float low = node[0] + sx * (node[1] - node[0]);
  const float high = node[columns_] + sx * (node[columns_ + 1] - node[columns_]);
  return low + sy * (high - low);
}

std::vector<LightMap> bake_lighting(const Scene& scene) {
  const Occluders occluders = all_occluders(scene);
  std::vector<LightMap> maps;
  maps.reserve(scene.surfaces.size());
  for (const Surface& surface : scene.surfaces) maps.emplace_back(surface.bounds().max(), kSpacing);

  tbb::parallel_for(std::size_t{0}, maps.size(), [&](std::size_t i) {
    const Surface& surface = scene.surfaces[i];
    LightMap& map = maps[i];
    for (int row = 0; row < map.rows(); ++row) {
      for (int column = 0; column < map.columns(); ++column) {
        const Vector3d place = place_of(surface, map.node(column, row));
        double light = scene.ambient * ambient_light(occluders, surface, place);
        for (const Lamp& lamp : scene.lamps) light += lamp_light(occluders, lamp, surface, place);
        map.at(column, row) = static_cast<float>(light);
      }
    }
  });
  return maps;
}

}  // namespace eg::synthetic
