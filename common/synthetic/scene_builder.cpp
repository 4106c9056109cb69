#include "common/synthetic/scene_builder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/check.hpp"
#include "common/geometry/so3.hpp"

namespace eg::synthetic {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Surface rectangle(const Vector3d& origin, const Vector3d& axis_u, const Vector3d& axis_v, double width, double height,
                  Material material) {
  material.extent = {static_cast<float>(width), static_cast<float>(height)};
  return {origin, axis_u, axis_v, {{0, 0}, {width, 0}, {width, height}, {0, height}}, std::move(material)};
}

/// What a half plane {p : n · p + c >= 0} leaves of a convex polygon (one step of Sutherland and Hodgman's clipping).
std::vector<Vector2d> clip(const std::vector<Vector2d>& polygon, const Vector2d& n, double c) {
  std::vector<Vector2d> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    const double at_a = n.dot(a) + c;
    const double at_b = n.dot(b) + c;
    if (at_a >= 0) kept.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return kept;
}

/// A large square on the plane, with v as far upwards as the plane allows.
Surface unbounded(const geometry::Plane& plane, const Material& material) {
  const bool level = std::abs(plane.normal.z()) > 0.99;
  const Vector3d up = level ? Vector3d::UnitY() : Vector3d::UnitZ();
  const Vector3d axis_v = (up - up.dot(plane.normal) * plane.normal).normalized();
  const Vector3d axis_u = axis_v.cross(plane.normal);
  constexpr double kFar = 100.0;
  return {-plane.distance * plane.normal,
          axis_u,
          axis_v,
          {{-kFar, -kFar}, {kFar, -kFar}, {kFar, kFar}, {-kFar, kFar}},
          material};
}

/// Moves the origin so that the outline starts at u = 0, v = 0.
void normalise_origin(Surface& surface) {
  const Eigen::AlignedBox2d box = surface.bounds();
  surface.origin = surface.point(box.min());
  for (Vector2d& corner : surface.outline) corner -= box.min();
  surface.material.extent = box.sizes().cast<float>();
}

}  // namespace

geometry::Pose standing_at(double x, double y, double yaw) { return {geometry::so3_exp({0, 0, yaw}), {x, y, 0.0}}; }

geometry::Pose mounted_at(const Surface& surface, double u, double v) {
  geometry::Pose world_from_frame;
  world_from_frame.rotation << surface.axis_u, -surface.normal(), surface.axis_v;
  world_from_frame.translation = surface.point({u, v});
  return world_from_frame;
}

void SceneBuilder::box(const geometry::Pose& world_from_frame, const Vector3d& low, const Vector3d& high,
                       unsigned faces, const Material& rest, const Material& front) {
  EG_CHECK((high - low).minCoeff() > 0, "a box has a positive size");
  const Vector3d size = high - low;
  const auto face = [&](unsigned which, const Vector3d& corner, const Vector3d& u, const Vector3d& v) {
    if ((faces & which) == 0) return;
    const Material& material = which == kFront ? front : rest;
    scene_.surfaces.push_back(rectangle(world_from_frame * corner, world_from_frame.rotation * u,
                                        world_from_frame.rotation * v, std::abs(u.dot(size)), std::abs(v.dot(size)),
                                        material));
  };
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = Vector3d::UnitY();
  const Vector3d z = Vector3d::UnitZ();
  face(kFront, low, x, z);
  face(kBack, {high.x(), high.y(), low.z()}, -x, z);
  face(kLeft, {low.x(), high.y(), low.z()}, -y, z);
  face(kRight, {high.x(), low.y(), low.z()}, y, z);
  face(kTop, {low.x(), low.y(), high.z()}, x, y);
  face(kBottom, {low.x(), high.y(), low.z()}, x, -y);
}

std::size_t SceneBuilder::interior(std::span<const geometry::Plane> planes, std::span<const Material> materials) {
  EG_CHECK(planes.size() == materials.size(), "one material per plane");
  const std::size_t first = scene_.surfaces.size();
  for (std::size_t i = 0; i < planes.size(); ++i) {
    Surface surface = unbounded(planes[i], materials[i]);
    for (std::size_t j = 0; j < planes.size(); ++j) {
      if (j == i) continue;
      const Vector2d n(planes[j].normal.dot(surface.axis_u), planes[j].normal.dot(surface.axis_v));
      surface.outline = clip(surface.outline, n, planes[j].signed_distance(surface.origin));
    }
    EG_CHECK(surface.outline.size() >= 3 && surface.outline.size() <= Surface::kMaxCorners,
             "every plane bounds the room");
    normalise_origin(surface);
    scene_.surfaces.push_back(std::move(surface));
  }
  return first;
}

void SceneBuilder::moulding(const geometry::Pose& world_from_frame, double width, double height, double bar,
                            double thickness, const Material& material, bool with_sill) {
  const double foot = with_sill ? -bar : 0.0;
  box(world_from_frame, {-bar, -thickness, foot}, {0, 0, height + bar}, kHanging, material);
  box(world_from_frame, {width, -thickness, foot}, {width + bar, 0, height + bar}, kHanging, material);
  box(world_from_frame, {0, -thickness, height}, {width, 0, height + bar}, kFront | kTop | kBottom, material);
  if (with_sill) box(world_from_frame, {0, -thickness, -bar}, {width, 0, 0}, kFront | kTop | kBottom, material);
}

void SceneBuilder::skirting(std::size_t wall, double height, double thickness, const Material& material) {
  const Surface& surface = scene_.surfaces[wall];
  const double width = surface.bounds().sizes().x();
  box(mounted_at(surface, 0, 0), {0, -thickness, 0}, {width, 0, height}, kFront | kTop, material);
}

}  // namespace eg::synthetic
