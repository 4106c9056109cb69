#include <egraph_msgs/graph_snapshot_t.hpp>
#include <egraph_msgs/graph_update_t.hpp>

#include "common/messages/codec.hpp"
#include "common/messages/guard.hpp"
#include "common/messages/list.hpp"
#include "common/messages/wire.hpp"
#include "common/messages/wire_direction.hpp"
#include "common/messages/wire_geometry.hpp"
#include "common/messages/wire_graph.hpp"

namespace eg::messages {
using egraph::GraphSnapshot;
using egraph::GraphUpdate;
using CovisibilityEdge = GraphSnapshot::CovisibilityEdge;

static egraph_msgs::covisibility_edge_t write(const CovisibilityEdge& edge) {
  egraph_msgs::covisibility_edge_t wire{};
  wire.first = edge.first.value;
  wire.second = edge.second.value;
  wire.shared_features = edge.shared_features;
  return wire;
}

static CovisibilityEdge read(const egraph_msgs::covisibility_edge_t& wire, const Path& path, Checker& check) {
  return {read_id<egraph::KeyframeId>(wire.first, path("first"), check),
          read_id<egraph::KeyframeId>(wire.second, path("second"), check),
          read_count(wire.shared_features, path("shared_features"), check)};
}

/// The lists that both kinds of message have, with the same names.
template <typename Graph, typename Wire>
static void write_lists(const Graph& graph, Wire& wire) {
  write_list(graph.landmarks, wire.num_landmarks, wire.landmarks, write);
  write_list(graph.observations, wire.num_observations, wire.observations, write);
  write_list(graph.relative_poses, wire.num_relative_poses, wire.relative_poses, write);
}

template <typename Wire, typename Graph>
static void read_lists(const Wire& wire, const Path& path, Checker& check, Graph& graph) {
  graph.landmarks = read_list<egraph::DirectionLandmark>(wire.landmarks, "landmarks", path, check, read);
  graph.observations = read_list<egraph::Observation>(wire.observations, "observations", path, check, read);
  graph.relative_poses = read_list<egraph::RelativePose>(wire.relative_poses, "relative_poses", path, check, read);
}

static base::Result<GraphUpdate> decode_update(ByteView bytes) {
  const auto wire = decode_wire<egraph_msgs::graph_update_t>(
      bytes,
      {{"num_landmarks", kMaxGraphNodes, wire_size<egraph_msgs::landmark_t>()},
       {"num_removed", kMaxGraphNodes, sizeof(std::int32_t)},
       {"num_observations", kMaxGraphEdges, wire_size<egraph_msgs::observation_t>()},
       {"num_covisible", kMaxGraphNodes, wire_size<egraph_msgs::covisibility_t>()},
       {"num_relative_poses", kMaxGraphEdges, wire_size<egraph_msgs::relative_pose_t>()},
       {"num_moved", kMaxGraphNodes, wire_size<egraph_msgs::corrected_pose_t>()},
       {"num_corrections", kMaxGraphNodes, wire_size<egraph_msgs::corrected_pose_t>()}},
      {});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  GraphUpdate update;
  update.session = wire->session;
  update.base_version = read_counter(wire->base_version, path("base_version"), check);
  update.version = read_counter(wire->version, path("version"), check);
  check.require(update.version >= update.base_version, path("version"), "is older than base_version");
  update.keyframe = read(wire->keyframe, path("keyframe"), check);
  for (std::size_t i = 0; i < wire->removed.size(); ++i) {
    update.removed.push_back(read_id<egraph::LandmarkId>(wire->removed[i], path("removed", i), check));
  }
  read_lists(*wire, path, check, update);
  update.covisible = read_list<egraph::Covisibility>(wire->covisible, "covisible", path, check, read);
  update.moved = read_list<egraph::CorrectedPose>(wire->moved, "moved", path, check, read);
  update.corrections = read_list<egraph::CorrectedPose>(wire->corrections, "corrections", path, check, read);
  return checked(std::move(update), check);
}

static base::Result<GraphSnapshot> decode_snapshot(ByteView bytes) {
  const auto wire = decode_wire<egraph_msgs::graph_snapshot_t>(
      bytes,
      {{"num_keyframes", kMaxGraphNodes, wire_size<egraph_msgs::keyframe_node_t>()},
       {"num_landmarks", kMaxGraphNodes, wire_size<egraph_msgs::landmark_t>()},
       {"num_observations", kMaxGraphEdges, wire_size<egraph_msgs::observation_t>()},
       {"num_covisibility", kMaxGraphEdges, wire_size<egraph_msgs::covisibility_edge_t>()},
       {"num_relative_poses", kMaxGraphEdges, wire_size<egraph_msgs::relative_pose_t>()}},
      {});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  GraphSnapshot snapshot;
  snapshot.session = wire->session;
  snapshot.version = read_counter(wire->version, path("version"), check);
  check.in_range(path("parts"), wire->parts, 1, kMaxSnapshotParts);
  check.in_range(path("part"), wire->part, 0, std::int64_t{wire->parts} - 1);
  snapshot.part = wire->part;
  snapshot.parts = wire->parts;
  snapshot.next_landmark = read_id<egraph::LandmarkId>(wire->next_landmark, path("next_landmark"), check);
  snapshot.keyframes = read_list<egraph::KeyframeNode>(wire->keyframes, "keyframes", path, check, read);
  read_lists(*wire, path, check, snapshot);
  snapshot.covisibility = read_list<CovisibilityEdge>(wire->covisibility, "covisibility", path, check, read);
  return checked(std::move(snapshot), check);
}

Bytes encode(const GraphUpdate& update) {
  egraph_msgs::graph_update_t wire{};
  wire.session = update.session;
  wire.base_version = update.base_version;
  wire.version = update.version;
  wire.keyframe = write(update.keyframe);
  for (const egraph::LandmarkId landmark : update.removed) wire.removed.push_back(landmark.value);
  wire.num_removed = static_cast<std::int32_t>(wire.removed.size());
  write_lists(update, wire);
  write_list(update.covisible, wire.num_covisible, wire.covisible, write);
  write_list(update.moved, wire.num_moved, wire.moved, write);
  write_list(update.corrections, wire.num_corrections, wire.corrections, write);
  return encode_wire(wire);
}

Bytes encode(const GraphSnapshot& snapshot) {
  egraph_msgs::graph_snapshot_t wire{};
  wire.session = snapshot.session;
  wire.version = snapshot.version;
  wire.part = snapshot.part;
  wire.parts = snapshot.parts;
  wire.next_landmark = snapshot.next_landmark.value;
  write_list(snapshot.keyframes, wire.num_keyframes, wire.keyframes, write);
  write_lists(snapshot, wire);
  write_list(snapshot.covisibility, wire.num_covisibility, wire.covisibility, write);
  return encode_wire(wire);
}

template <>
base::Result<GraphUpdate> decode(ByteView bytes) {
  return guarded<GraphUpdate>([&] { return decode_update(bytes); });
}

template <>
base::Result<GraphSnapshot> decode(ByteView bytes) {
  return guarded<GraphSnapshot>([&] { return decode_snapshot(bytes); });
}

}  // namespace eg::messages
