#pragma once

#include <egraph_msgs/covisibility_t.hpp>
#include <egraph_msgs/direction_t.hpp>

#include "common/egraph/types.hpp"
#include "common/messages/checker.hpp"

/// What features and keyframes, or keyframes and the graph, both hold.
namespace eg::messages {

egraph_msgs::direction_t write(const features::DirectionFeature& feature);
egraph_msgs::covisibility_t write(const egraph::Covisibility& covisibility);

/// Does not know how many planes and lines the frame has: `source` is only checked to be -1 or more.
features::DirectionFeature read(const egraph_msgs::direction_t& wire, const Path& path, Checker& check);
egraph::Covisibility read(const egraph_msgs::covisibility_t& wire, const Path& path, Checker& check);

}  // namespace eg::messages
