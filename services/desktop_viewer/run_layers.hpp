#pragma once

#include <filesystem>
#include <vector>

#include "common/base/result.hpp"
#include "services/desktop_viewer/layer.hpp"

namespace eg::services {

/// Where the results of a run are.
struct RunFiles {
  std::filesystem::path folder;        ///< egraph-run's --out
  std::filesystem::path ground_truth;  ///< TUM format; empty: groundtruth.txt in the folder, if it is there
  bool y_up = false;                   ///< the camera's fy is negative: the world is mirrored
};

/// What a run has left, as layers in this order, each only if its file is there: mesh (mesh.ply), points and lines
/// (map.ply; off at first if there is a mesh), trajectory, ground truth (aligned rigidly to the trajectory), keyframes,
/// E-Graph (egraph.json). Up is where most of the mesh says (eval::refine_up), else where the first camera has it.
///
/// Errors: none of the files is in the folder; one that cannot be read; a ground truth that has fewer than 10 poses
/// within 0.02 s of the trajectory's.
base::Result<std::vector<Layer>> read_run(const RunFiles& files);

}  // namespace eg::services
