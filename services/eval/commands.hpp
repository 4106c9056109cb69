#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/base/result.hpp"

/// The commands of egraph-eval: each reads its files and measures. Errors name the file.
namespace eg::service {

/// One result, for people and for programs.
struct Report {
  std::string table;
  nlohmann::ordered_json json;
};

base::Result<Report> report_trajectory(const std::filesystem::path& estimate, const std::filesystem::path& reference);

/// `camera`: a name or file, whose field of view decides which views overlap.
base::Result<Report> report_graph(const std::filesystem::path& graph, const std::filesystem::path& reference,
                                  const std::string& camera);

/// The trajectories whose rigid alignment takes the estimated mesh into the reference's frame.
struct MeshAlignment {
  std::filesystem::path estimate;
  std::filesystem::path reference;
};
base::Result<Report> report_mesh(const std::filesystem::path& mesh, const std::filesystem::path& reference,
                                 const std::optional<MeshAlignment>& alignment);

}  // namespace eg::service
