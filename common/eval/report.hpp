#pragma once

#include <string>

#include "common/eval/drift.hpp"
#include "common/eval/graph_errors.hpp"
#include "common/eval/mesh_errors.hpp"
#include "common/eval/trajectory_errors.hpp"

/// Results as tables for people to read; several lines, each ended.
namespace eg::eval {

std::string table_of(const TrajectoryErrors& errors);
std::string table_of(const Drift& drift);
std::string table_of(const GraphErrors& errors);
std::string table_of(const MeshErrors& errors);

}  // namespace eg::eval
