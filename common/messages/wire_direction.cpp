#include "common/messages/wire_direction.hpp"

#include "common/messages/wire_geometry.hpp"

namespace eg::messages {

egraph_msgs::direction_t write(const features::DirectionFeature& feature) {
  egraph_msgs::direction_t wire{};
  wire.kind = static_cast<std::int8_t>(feature.kind);
  write_vector(feature.direction, wire.direction);
  write_symmetric(feature.covariance, wire.covariance);
  wire.support = feature.support;
  wire.source = feature.source;
  return wire;
}

features::DirectionFeature read(const egraph_msgs::direction_t& wire, const Path& path, Checker& check) {
  features::DirectionFeature feature;
  feature.kind = read_enum(wire.kind, features::DirectionKind::potential_direction, path("kind"), check);
  feature.direction = read_vector(wire.direction);
  check.unit_vector(path("direction"), feature.direction);
  feature.covariance = read_covariance<3>(wire.covariance, path("covariance"), check);
  feature.support = read_count(wire.support, path("support"), check);
  feature.source = wire.source;
  check.in_range(path("source"), wire.source, -1, INT32_MAX);
  return feature;
}

egraph_msgs::covisibility_t write(const egraph::Covisibility& covisibility) {
  egraph_msgs::covisibility_t wire{};
  wire.keyframe = covisibility.keyframe.value;
  wire.shared_features = covisibility.shared_features;
  return wire;
}

egraph::Covisibility read(const egraph_msgs::covisibility_t& wire, const Path& path, Checker& check) {
  return {read_id<egraph::KeyframeId>(wire.keyframe, path("keyframe"), check),
          read_count(wire.shared_features, path("shared_features"), check)};
}

}  // namespace eg::messages
