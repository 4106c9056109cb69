#pragma once

#include <nlohmann/json.hpp>

#include "common/eval/drift.hpp"
#include "common/eval/graph_errors.hpp"
#include "common/eval/mesh_errors.hpp"
#include "common/eval/trajectory_errors.hpp"

/// What `egraph-eval ... --json` prints. The figures that people compare come first, whole statistics below them.
/// Statistics of nothing are null.
namespace eg::service {

nlohmann::ordered_json json_of(const eval::TrajectoryErrors& errors);
nlohmann::ordered_json json_of(const eval::Drift& drift);
nlohmann::ordered_json json_of(const eval::GraphErrors& errors);
nlohmann::ordered_json json_of(const eval::MeshErrors& errors);

}  // namespace eg::service
