#include "common/messages/wire_graph.hpp"

#include "common/messages/wire_geometry.hpp"

namespace eg::messages {

using egraph::KeyframeId;
using egraph::LandmarkId;

egraph_msgs::keyframe_node_t write(const egraph::KeyframeNode& node) {
  egraph_msgs::keyframe_node_t wire{};
  wire.id = node.id.value;
  wire.sequence = node.sequence;
  wire.utime = node.utime;
  wire.world_from_camera = write(node.world_from_camera);
  write_symmetric(node.covariance, wire.covariance);
  return wire;
}

egraph::KeyframeNode read(const egraph_msgs::keyframe_node_t& wire, const Path& path, Checker& check) {
  egraph::KeyframeNode node;
  node.id = read_id<KeyframeId>(wire.id, path("id"), check);
  node.sequence = read_counter(wire.sequence, path("sequence"), check);
  node.utime = read_counter(wire.utime, path("utime"), check);
  node.world_from_camera = read(wire.world_from_camera, path("world_from_camera"), check);
  node.covariance = read_covariance<6>(wire.covariance, path("covariance"), check);
  return node;
}

egraph_msgs::landmark_t write(const egraph::DirectionLandmark& landmark) {
  egraph_msgs::landmark_t wire{};
  wire.id = landmark.id.value;
  wire.kind = static_cast<std::int8_t>(landmark.kind);
  write_vector(landmark.direction, wire.direction);
  write_symmetric(landmark.covariance, wire.covariance);
  wire.observations = landmark.observations;
  wire.first_seen = landmark.first_seen.value;
  wire.last_seen = landmark.last_seen.value;
  return wire;
}

egraph::DirectionLandmark read(const egraph_msgs::landmark_t& wire, const Path& path, Checker& check) {
  egraph::DirectionLandmark landmark;
  landmark.id = read_id<LandmarkId>(wire.id, path("id"), check);
  landmark.kind = read_enum(wire.kind, features::DirectionKind::potential_direction, path("kind"), check);
  landmark.direction = read_vector(wire.direction);
  check.unit_vector(path("direction"), landmark.direction);
  landmark.covariance = read_covariance<3>(wire.covariance, path("covariance"), check);
  landmark.observations = read_count(wire.observations, path("observations"), check);
  landmark.first_seen = read_optional_id<KeyframeId>(wire.first_seen, path("first_seen"), check);
  landmark.last_seen = read_optional_id<KeyframeId>(wire.last_seen, path("last_seen"), check);
  return landmark;
}

egraph_msgs::observation_t write(const egraph::Observation& observation) {
  egraph_msgs::observation_t wire{};
  wire.keyframe = observation.keyframe.value;
  wire.landmark = observation.landmark.value;
  write_vector(observation.direction_in_camera, wire.direction_in_camera);
  write_symmetric(observation.covariance, wire.covariance);
  return wire;
}

egraph::Observation read(const egraph_msgs::observation_t& wire, const Path& path, Checker& check) {
  egraph::Observation observation;
  observation.keyframe = read_id<KeyframeId>(wire.keyframe, path("keyframe"), check);
  observation.landmark = read_id<LandmarkId>(wire.landmark, path("landmark"), check);
  observation.direction_in_camera = read_vector(wire.direction_in_camera);
  check.unit_vector(path("direction_in_camera"), observation.direction_in_camera);
  observation.covariance = read_covariance<3>(wire.covariance, path("covariance"), check);
  return observation;
}

WireEdges write(const std::vector<egraph::Edge>& edges) {
  WireEdges wire;
  wire.edges.reserve(edges.size());
  for (const egraph::Edge& edge : edges) {
    egraph_msgs::edge_t item{};
    item.first = edge.first.value;
    item.second = edge.second.value;
    item.num_shared = static_cast<std::int32_t>(edge.shared.size());
    wire.edges.push_back(item);
    for (const LandmarkId landmark : edge.shared) wire.shared_landmarks.push_back(landmark.value);
  }
  return wire;
}

std::vector<egraph::Edge> read_edges(const std::vector<egraph_msgs::edge_t>& edges,
                                     const std::vector<std::int32_t>& shared_landmarks, const Path& path,
                                     Checker& check) {
  std::vector<egraph::Edge> result;
  result.reserve(edges.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Path at = path("edges", i);
    egraph::Edge edge{read_id<KeyframeId>(edges[i].first, at("first"), check),
                      read_id<KeyframeId>(edges[i].second, at("second"), check),
                      {}};
    check.require(edge.first != edge.second, at("second"), "is the same keyframe as the first");
    check.in_range(at("num_shared"), edges[i].num_shared, 0, static_cast<std::int64_t>(shared_landmarks.size() - next));
    if (!check.ok()) return {};
    for (const std::size_t end = next + static_cast<std::size_t>(edges[i].num_shared); next < end; ++next) {
      edge.shared.push_back(read_id<LandmarkId>(shared_landmarks[next], path("shared_landmarks", next), check));
    }
    result.push_back(std::move(edge));
  }
  check.require(next == shared_landmarks.size(), path("num_shared_landmarks"), "is not the sum of the edges' lists");
  return result;
}

}  // namespace eg::messages
