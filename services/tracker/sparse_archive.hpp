#pragma once

#include <filesystem>

#include "common/egraph/graph.hpp"
#include "common/tracking/map.hpp"

namespace eg::services {

/// What the tracker keeps in a map archive.
struct SparseArchive {
  tracking::Map map;
  egraph::Graph graph;
};

/// Writes map and graph, whole or not at all.
base::Status save_sparse_archive(const std::filesystem::path& path, const tracking::Map& map,
                                 const egraph::Graph& graph);

/// Reads them back. Refuses what is damaged, of another version, incomplete or contradicts itself, naming file and
/// record.
base::Result<SparseArchive> load_sparse_archive(const std::filesystem::path& path);

}  // namespace eg::services
