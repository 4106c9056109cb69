#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "common/egraph/types.hpp"

namespace eg::io {

/// The E-Graph as JSON (egraph.json), one node or edge per line:
///   {"version": 1,
///    "keyframes":    [{id, sequence, time_s, position [x,y,z], orientation [w,x,y,z], covariance [21]}],
///    "landmarks":    [{id, kind, direction [x,y,z], sigma_deg, covariance [6], observations, first_seen, last_seen}],
///    "observations": [{keyframe, landmark, direction [x,y,z], covariance [6]}],
///    "edges":        [{first, second, landmarks [ids]}],
///    "covisibility": [{first, second, shared_features}]}
/// `kind` is "plane", "vanishing_direction" or "potential_direction"; poses are camera to world; metres, seconds,
/// radians squared; covariances are upper triangles, row by row; `sigma_deg` is what `covariance` says, for people.
/// Equal graphs give equal bytes: session and version numbers of the running system and the relative poses
/// are left out.
std::string format_graph(const egraph::GraphWithEdges& graph);

/// Errors name the field, e.g. "landmarks[3].direction: must be 3 numbers"; references to nodes that do not exist,
/// repeated ids, directions and quaternions that are not unit are refused.
base::Result<egraph::GraphWithEdges> parse_graph(std::string_view json);

base::Status write_graph(const std::filesystem::path& path, const egraph::GraphWithEdges& graph);
base::Result<egraph::GraphWithEdges> read_graph(const std::filesystem::path& path);

}  // namespace eg::io
