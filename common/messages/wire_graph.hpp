#pragma once

#include <egraph_msgs/edge_t.hpp>
#include <egraph_msgs/keyframe_node_t.hpp>
#include <egraph_msgs/landmark_t.hpp>
#include <egraph_msgs/observation_t.hpp>
#include <vector>

#include "common/egraph/types.hpp"
#include "common/messages/checker.hpp"

/// The parts of the E-Graph that updates and snapshots share.
namespace eg::messages {

egraph_msgs::keyframe_node_t write(const egraph::KeyframeNode& node);
egraph_msgs::landmark_t write(const egraph::DirectionLandmark& landmark);
egraph_msgs::observation_t write(const egraph::Observation& observation);

egraph::KeyframeNode read(const egraph_msgs::keyframe_node_t& wire, const Path& path, Checker& check);
egraph::DirectionLandmark read(const egraph_msgs::landmark_t& wire, const Path& path, Checker& check);
egraph::Observation read(const egraph_msgs::observation_t& wire, const Path& path, Checker& check);

/// Edges as messages hold them: the landmarks that they share stand in one list, one edge after the other.
struct WireEdges {
  std::vector<egraph_msgs::edge_t> edges;
  std::vector<std::int32_t> shared_landmarks;
};

WireEdges write(const std::vector<egraph::Edge>& edges);
std::vector<egraph::Edge> read_edges(const std::vector<egraph_msgs::edge_t>& edges,
                                     const std::vector<std::int32_t>& shared_landmarks, const Path& path,
                                     Checker& check);

}  // namespace eg::messages
