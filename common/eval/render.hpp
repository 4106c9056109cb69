#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <numbers>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/eval/surface.hpp"
#include "common/geometry/pose.hpp"

/// Pictures of results, drawn in memory: no display, no graphics card.
namespace eg::eval {

/// A mesh with what is needed to see it. Normals (unit, out of the surface) and colours (red, green, blue): none, or
/// one per vertex.
struct ColouredSurface {
  SurfaceView shape;
  std::span<const Eigen::Vector3f> normals = {};
  std::span<const std::array<std::uint8_t, 3>> colours = {};
};

/// A line through space.
struct Path {
  std::string label;
  std::vector<Eigen::Vector3d> points;  ///< metres
  cv::Scalar colour;                    ///< BGR
};

struct RenderOptions {
  int width = 1280;  ///< pixels
  int height = 960;
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();    ///< away from the floor; optical frames have y down
  Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ();  ///< roughly into the picture
  bool mirrored = false;   ///< coordinates are left-handed, as the camera's negative fy makes them (docs/frames.md)
  double azimuth = 0.5;    ///< radians, from where beside `ahead` one looks
  double elevation = 0.9;  ///< radians, how steeply one looks down
};

/// Options for a world with the axes of its first camera: y down, or, for a negative fy, y up and mirrored.
RenderOptions render_options_for(bool y_up);

/// The direction near `guess` (within 40 degrees) that most of the surface is perpendicular to: the floor's and
/// ceiling's normal, if the map has them; else the guess. Unit.
Eigen::Vector3d refine_up(const ColouredSurface& surface, const Eigen::Vector3d& guess);

/// The azimuth (radians) from which most of the surface, by its area in the picture, is seen from its front.
double best_azimuth(const ColouredSurface& surface, const RenderOptions& options);

/// Looks into the room from above: surfaces are lit from above, those seen from behind (ceiling, near walls) are left
/// out; paths and keyframes (small view pyramids) are drawn on top. CV_8UC3, BGR, options.width x options.height.
cv::Mat render_scene(const ColouredSurface& surface, std::span<const Path> paths,
                     std::span<const geometry::Pose> keyframes, const RenderOptions& options);

/// The paths seen from above, from the front and from the side, with a scale. CV_8UC3, BGR, `width` x `height`.
cv::Mat plot_paths(std::span<const Path> paths, const RenderOptions& options, int width, int height);

/// Edges between keyframes, as indices into a list of their positions.
struct PlottedGraph {
  std::string title;
  std::vector<std::pair<std::size_t, std::size_t>> edges;
  cv::Scalar colour;  ///< BGR
};

/// Graphs over the same keyframes (positions in metres, in increasing time) side by side: the edges seen from above, as
/// in the paper's comparison of E-Graph and covisibility graph, and below the adjacency matrices, in which dense graphs
/// can be told apart. CV_8UC3, BGR, options.width wide.
cv::Mat render_graphs(std::span<const Eigen::Vector3d> keyframes, std::span<const PlottedGraph> graphs,
                      const RenderOptions& options);

/// All that is known about a run, in the frame of the estimate; each part may be empty.
struct Overview {
  ColouredSurface surface;
  std::span<const geometry::StampedPose> estimate;
  std::span<const geometry::StampedPose> reference;  ///< in its own frame: it is aligned rigidly to the estimate
  std::span<const geometry::Pose> keyframes;
};

/// The scene above, the plots below it; refine_up() and best_azimuth() choose the point of view.
cv::Mat render_overview(const Overview& overview, RenderOptions options);

}  // namespace eg::eval
