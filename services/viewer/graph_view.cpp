#include "services/viewer/graph_view.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <utility>
#include <vector>

#include "services/viewer/arrays.hpp"
#include "services/viewer/packet.hpp"

namespace eg::services {
namespace {

constexpr std::size_t kMaxKeyframes = 100'000;
/// Edges are drawn to the oldest keyframes that saw a landmark: nobody can tell more lines apart.
constexpr std::size_t kMaxObservers = 200;
constexpr std::int32_t kPosesPerBlock = 64;
constexpr std::int32_t kNodesPerBlock = 16;

/// What one packet "graph" holds: keyframes of a range of ids, and what leads from them to older ones.
struct Block {
  std::vector<std::int32_t> keyframes, edges, covisibility, observations;
  std::vector<std::int32_t> edge_weights, covisibility_weights;  ///< shared landmarks, shared features
  std::vector<float> times, directions;
};

using Blocks = std::map<std::int32_t, Block>;

void add_nodes(const egraph::GraphSnapshot& graph, Blocks& blocks) {
  if (graph.keyframes.empty()) return;
  const std::int64_t first_utime = graph.keyframes.front().utime;
  for (const egraph::KeyframeNode& node : graph.keyframes) {
    Block& block = blocks[node.id.value / kNodesPerBlock];
    block.keyframes.push_back(node.id.value);
    block.times.push_back(static_cast<float>(1e-6 * static_cast<double>(node.utime - first_utime)));
  }
}

void add_edges(const egraph::Graph& graph, Blocks& blocks) {
  for (const egraph::Edge& edge : graph.edges(kMaxObservers)) {
    Block& block = blocks[edge.second.value / kNodesPerBlock];
    block.edges.insert(block.edges.end(), {edge.first.value, edge.second.value});
    block.edge_weights.push_back(static_cast<std::int32_t>(edge.shared.size()));
  }
}

void add_covisibility(const egraph::GraphSnapshot& graph, Blocks& blocks) {
  for (const auto& edge : graph.covisibility) {
    Block& block = blocks[std::max(edge.first, edge.second).value / kNodesPerBlock];
    block.covisibility.insert(block.covisibility.end(), {edge.first.value, edge.second.value});
    block.covisibility_weights.push_back(edge.shared_features);
  }
}

void add_observations(const egraph::GraphSnapshot& graph, Blocks& blocks) {
  for (const egraph::Observation& observation : graph.observations) {
    Block& block = blocks[observation.keyframe.value / kNodesPerBlock];
    block.observations.insert(block.observations.end(), {observation.keyframe.value, observation.landmark.value});
    append(block.directions, observation.direction_in_camera);
  }
}

std::vector<std::uint8_t> to_packet(std::int32_t number, const Block& block) {
  return Packet("graph")
      .set("block", number)
      .array("keyframes", block.keyframes)
      .array("times", block.times)
      .array("edges", block.edges)
      .array("edges_weights", block.edge_weights)
      .array("covisibility", block.covisibility)
      .array("covisibility_weights", block.covisibility_weights)
      .array("observations", block.observations)
      .array("directions", block.directions)
      .bytes();
}

std::vector<std::uint8_t> landmarks_packet(const egraph::Graph& graph, const DirectionColours& colours) {
  std::vector<std::int32_t> ids, counts, numbers;
  std::vector<std::uint8_t> kinds;
  std::vector<float> directions;
  for (const egraph::DirectionLandmark& landmark : graph.landmarks()) {
    ids.push_back(landmark.id.value);
    kinds.push_back(static_cast<std::uint8_t>(landmark.kind));
    counts.push_back(landmark.observations);
    numbers.push_back(colours.of(landmark.direction));
    append(directions, landmark.direction);
  }
  return Packet("landmarks")
      .set("version", static_cast<double>(graph.version()))
      .array("ids", ids)
      .array("kinds", kinds)
      .array("observations", counts)
      .array("colours", numbers)
      .array("directions", directions)
      .bytes();
}

}  // namespace

bool GraphView::apply(const egraph::GraphUpdate& update) {
  if (!graph_.apply(update)) return false;
  take_over_poses();
  return true;
}

bool GraphView::apply(const egraph::GraphSnapshot& part) {
  if (part.version <= graph_.version()) return true;
  const auto snapshot = parts_.add(part);
  if (!snapshot || !graph_.reset(*snapshot)) return false;
  take_over_poses();
  return true;
}

void GraphView::apply(const tracking::PoseCorrection& correction) {
  if (correction.version < correction_version_) return;
  correction_version_ = correction.version;
  for (const auto& entry : correction.entries) correct(entry.keyframe, entry.world_from_camera);
}

void GraphView::add_keyframe(egraph::KeyframeId id, const geometry::Pose& world_from_camera) {
  // An announcement that is repeated is older than what corrections have made of it.
  if (poses_.size() < kMaxKeyframes) poses_.try_emplace(id, world_from_camera);
}

/// The graph knows where a keyframe was when it was announced: good for those that nobody has told more about.
void GraphView::take_over_poses() {
  for (const egraph::KeyframeNode& node : graph_.keyframes()) {
    add_keyframe(node.id, node.world_from_camera);
  }
  colours_ = DirectionColours(graph_.landmarks());
}

void GraphView::correct(egraph::KeyframeId id, const geometry::Pose& world_from_camera) {
  if (poses_.size() < kMaxKeyframes || poses_.contains(id)) poses_[id] = world_from_camera;
  ++corrections_;
}

const geometry::Pose* GraphView::find_pose(egraph::KeyframeId id) const {
  const auto found = poses_.find(id);
  return found == poses_.end() ? nullptr : &found->second;
}

Eigen::Vector3d GraphView::up(bool y_up) const {
  const Eigen::Vector3d guess = y_up ? Eigen::Vector3d::UnitY() : Eigen::Vector3d(-Eigen::Vector3d::UnitY());
  const double tolerance = std::cos(0.7);
  Eigen::Vector3d up = guess;
  std::int32_t most = 0;
  for (const egraph::DirectionLandmark& landmark : graph_.landmarks()) {
    if (landmark.kind != egraph::DirectionKind::plane_normal || landmark.observations <= most) continue;
    const double cosine = landmark.direction.dot(guess);
    if (std::abs(cosine) < tolerance) continue;
    most = landmark.observations;
    up = cosine > 0.0 ? landmark.direction : Eigen::Vector3d(-landmark.direction);
  }
  return up;
}

bool GraphView::put_poses(Board& board) const {
  std::map<std::int32_t, std::pair<std::vector<std::int32_t>, std::vector<float>>> blocks;
  for (const auto& [id, pose] : poses_) {
    auto& [ids, numbers] = blocks[id.value / kPosesPerBlock];
    ids.push_back(id.value);
    append_pose(numbers, pose);
  }
  bool all = true;
  for (const auto& [number, block] : blocks) {
    Packet packet("poses");
    packet.array("ids", block.first).array("poses", block.second);
    all = board.put(fmt::format("poses/{}", number), packet.bytes()) && all;
  }
  return all;
}

bool GraphView::put_graph(Board& board) const {
  const egraph::GraphSnapshot snapshot = graph_.snapshot(0);
  Blocks blocks;
  add_nodes(snapshot, blocks);
  add_edges(graph_, blocks);
  add_covisibility(snapshot, blocks);
  add_observations(snapshot, blocks);
  bool all = board.put("landmarks", landmarks_packet(graph_, colours_));
  for (const auto& [number, block] : blocks) {
    all = board.put(fmt::format("graph/{}", number), to_packet(number, block)) && all;
  }
  return all;
}

}  // namespace eg::services
