#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/messages/codec.hpp"

namespace eg::messages {

/// Everything that a domain value holds, as three lists: two values are the same, bit for bit, if these are.
struct Flat {
  std::vector<std::uint64_t> reals;  ///< bit patterns of doubles
  std::vector<std::int64_t> integers;
  std::vector<std::string> texts;

  bool operator==(const Flat&) const = default;
  [[nodiscard]] bool all_finite() const;
};

Flat flatten(const image::RgbdFrame& frame);
Flat flatten(const features::FrameFeatures& frame);
Flat flatten(const tracking::PoseEstimate& pose);
Flat flatten(const tracking::PoseCorrection& correction);
/// A NaN in plane_distances, where it is allowed, counts as 0.
Flat flatten(const egraph::Keyframe& keyframe);
Flat flatten(const egraph::GraphUpdate& update);
Flat flatten(const egraph::GraphSnapshot& snapshot);
Flat flatten(const mapping::MeshChunk& chunk);
Flat flatten(const GraphRequest& request);
Flat flatten(const MeshRequest& request);
Flat flatten(const Acknowledge& acknowledge);
Flat flatten(const ResendRequest& request);
Flat flatten(const tracking::KeyframeLinks& links);
Flat flatten(const tracking::LandmarkPositions& landmarks);
Flat flatten(const EndOfStream& end);
Flat flatten(const Control& control);
Flat flatten(const ControlReply& reply);
Flat flatten(const ServiceStatus& status);

}  // namespace eg::messages
