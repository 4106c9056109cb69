#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/eval/render.hpp"

/// Drawings of the scene's plan as SVG, in the colours of the page (html.hpp).
namespace eg::report {

using Points = std::vector<Eigen::Vector3d>;  ///< metres

/// Estimate and truth (which may be empty) from above, from the front and from the side.
std::string draw_trajectories(const Points& estimate, const Points& truth, const eval::RenderOptions& options);

/// Keyframes at their positions from above, with edges between them (indices of keyframes).
std::string draw_graph(const Points& keyframes, std::span<const std::pair<std::size_t, std::size_t>> edges,
                       const std::string& colour, const std::string& caption, const eval::RenderOptions& options);

}  // namespace eg::report
