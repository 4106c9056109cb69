#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/eval/depth_cloud.hpp"

/// The commands of egraph-eval: each reads its files and measures. Errors name the file.
namespace eg::service {

/// One result, for people and for programs.
struct Report {
  std::string table;
  nlohmann::ordered_json json;
};

base::Result<Report> report_trajectory(const std::filesystem::path& estimate, const std::filesystem::path& reference);

base::Result<Report> report_drift(const std::filesystem::path& estimate, const std::filesystem::path& reference);

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

/// Whose depth images a cloud is made of.
struct CloudSource {
  std::filesystem::path dataset;      ///< folder of a recording
  std::string camera;                 ///< a name or file; empty: by the folder, as egraph-run finds it
  std::filesystem::path groundtruth;  ///< empty: the recording's own
};

/// Writes what all depth images show at their true poses as a cloud of points (PLY), a reference for report_mesh().
base::Result<Report> write_depth_cloud(const CloudSource& source, const eval::DepthCloudOptions& options,
                                       const std::filesystem::path& out);

/// Joins the meshes of mappers that share the space (egraph-mapper --tiles) along the borders of their tiles.
base::Result<Report> join_mesh_files(const std::filesystem::path& out, const std::vector<std::string>& parts);

/// What a picture is made of; empty paths are left out.
struct PictureFiles {
  std::filesystem::path mesh;
  std::filesystem::path trajectory;
  std::filesystem::path groundtruth;
  std::filesystem::path graph;  ///< for its keyframes
};

/// Draws mesh, trajectories and keyframes into a PNG file. `y_up`: the camera that made them has a negative fy. The
/// report says what was written.
base::Result<Report> render_picture(const PictureFiles& files, bool y_up, const std::filesystem::path& out);

/// Draws the edges of the E-Graph beside those of covisibility, seen from above, into a PNG file.
base::Result<Report> render_edges(const std::filesystem::path& graph, bool y_up, const std::filesystem::path& out);

}  // namespace eg::service
