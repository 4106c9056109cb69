#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/io/atomic_file.hpp"
#include "common/io/graph_json.hpp"
#include "common/io/graph_json_names.hpp"

namespace eg::io {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json orientation_of(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return Json::array({q.w(), q.x(), q.y(), q.z()});
}

template <int N>
Json upper_triangle(const Eigen::Matrix<double, N, N>& matrix) {
  Json values = Json::array();
  for (int row = 0; row < N; ++row) {
    for (int column = row; column < N; ++column) values.push_back(matrix(row, column));
  }
  return values;
}

/// Standard deviation along the least certain tangent, for people.
double sigma_deg(const Eigen::Matrix3d& covariance) {
  const double largest =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()(2);
  return std::sqrt(std::max(largest, 0.0)) * 180.0 / std::numbers::pi;
}

Json to_json(const egraph::KeyframeNode& keyframe) {
  return {{"id", keyframe.id.value},
          {"sequence", keyframe.sequence},
          {"time_s", static_cast<double>(keyframe.utime) / 1e6},
          {"position", to_json(keyframe.world_from_camera.translation)},
          {"orientation", orientation_of(keyframe.world_from_camera.rotation)},
          {"covariance", upper_triangle<6>(keyframe.covariance)}};
}

Json to_json(const egraph::DirectionLandmark& landmark) {
  return {{"id", landmark.id.value},
          {"kind", name_of(landmark.kind)},
          {"direction", to_json(landmark.direction)},
          {"sigma_deg", sigma_deg(landmark.covariance)},
          {"covariance", upper_triangle<3>(landmark.covariance)},
          {"observations", landmark.observations},
          {"first_seen", landmark.first_seen.value},
          {"last_seen", landmark.last_seen.value}};
}

Json to_json(const egraph::Observation& observation) {
  return {{"keyframe", observation.keyframe.value},
          {"landmark", observation.landmark.value},
          {"direction", to_json(observation.direction_in_camera)},
          {"covariance", upper_triangle<3>(observation.covariance)}};
}

Json to_json(const egraph::Edge& edge) {
  Json landmarks = Json::array();
  for (const egraph::LandmarkId id : edge.shared) landmarks.push_back(id.value);
  return {{"first", edge.first.value}, {"second", edge.second.value}, {"landmarks", landmarks}};
}

Json to_json(const egraph::GraphSnapshot::CovisibilityEdge& edge) {
  return {{"first", edge.first.value}, {"second", edge.second.value}, {"shared_features", edge.shared_features}};
}

template <typename T>
std::string section(const char* name, const std::vector<T>& items) {
  std::string text = std::string(",\n\"") + name + "\": [";
  for (std::size_t i = 0; i < items.size(); ++i) text += (i == 0 ? "\n" : ",\n") + to_json(items[i]).dump();
  return text + "]";
}

}  // namespace

std::string format_graph(const egraph::GraphWithEdges& graph) {
  return "{\"version\": " + std::to_string(kGraphJsonVersion) + section("keyframes", graph.keyframes) +
         section("landmarks", graph.landmarks) + section("observations", graph.observations) +
         section("edges", graph.edges) + section("covisibility", graph.covisibility) + "}\n";
}

base::Status write_graph(const std::filesystem::path& path, const egraph::GraphWithEdges& graph) {
  return write_file_atomically(path, format_graph(graph));
}

}  // namespace eg::io
