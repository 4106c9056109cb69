#pragma once

#include <egraph_msgs/corrected_pose_t.hpp>
#include <egraph_msgs/keyframe_node_t.hpp>
#include <egraph_msgs/landmark_t.hpp>
#include <egraph_msgs/observation_t.hpp>
#include <egraph_msgs/relative_pose_t.hpp>

#include "common/egraph/types.hpp"
#include "common/messages/checker.hpp"

/// The parts of the E-Graph that several messages share.
namespace eg::messages {

egraph_msgs::keyframe_node_t write(const egraph::KeyframeNode& node);
egraph_msgs::landmark_t write(const egraph::DirectionLandmark& landmark);
egraph_msgs::observation_t write(const egraph::Observation& observation);
egraph_msgs::relative_pose_t write(const egraph::RelativePose& relative);
egraph_msgs::corrected_pose_t write(const egraph::CorrectedPose& corrected);

egraph::KeyframeNode read(const egraph_msgs::keyframe_node_t& wire, const Path& path, Checker& check);
egraph::DirectionLandmark read(const egraph_msgs::landmark_t& wire, const Path& path, Checker& check);
egraph::Observation read(const egraph_msgs::observation_t& wire, const Path& path, Checker& check);
egraph::RelativePose read(const egraph_msgs::relative_pose_t& wire, const Path& path, Checker& check);
egraph::CorrectedPose read(const egraph_msgs::corrected_pose_t& wire, const Path& path, Checker& check);

}  // namespace eg::messages
