#pragma once

#include "common/base/random.hpp"
#include "common/messages/codec.hpp"

namespace eg::messages {

/// A valid value of any message type with every field set at random; lists have up to ten items.
template <typename T>
T random_value(base::Random& random);

template <>
image::RgbdFrame random_value(base::Random& random);
template <>
features::FrameFeatures random_value(base::Random& random);
template <>
tracking::PoseEstimate random_value(base::Random& random);
template <>
tracking::PoseCorrection random_value(base::Random& random);
template <>
egraph::Keyframe random_value(base::Random& random);
template <>
egraph::GraphUpdate random_value(base::Random& random);
template <>
egraph::GraphSnapshot random_value(base::Random& random);
template <>
mapping::MeshChunk random_value(base::Random& random);
template <>
GraphRequest random_value(base::Random& random);
template <>
MeshRequest random_value(base::Random& random);
template <>
Acknowledge random_value(base::Random& random);
template <>
ResendRequest random_value(base::Random& random);
template <>
tracking::KeyframeLinks random_value(base::Random& random);
template <>
tracking::LandmarkPositions random_value(base::Random& random);
template <>
EndOfStream random_value(base::Random& random);
template <>
Control random_value(base::Random& random);
template <>
ControlReply random_value(base::Random& random);
template <>
ServiceStatus random_value(base::Random& random);

}  // namespace eg::messages
