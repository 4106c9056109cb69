#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "common/features/features.hpp"
#include "common/image/rectifier.hpp"
#include "common/messages/codec.hpp"
#include "common/tracking/pose_estimate.hpp"
#include "services/viewer/direction_colours.hpp"

namespace eg::services {

/// The latest frames as they came over the bus, until the tracker's answer says what became of them.
class RecentFrames {
 public:
  void add(const messages::CompressedFrame& frame);
  void add(const features::FrameFeatures& features);

  /// Null: not there (any more).
  [[nodiscard]] const messages::CompressedFrame* find_frame(const image::FrameHeader& header) const;
  [[nodiscard]] const features::FrameFeatures* find_features(const image::FrameHeader& header) const;

 private:
  std::deque<messages::CompressedFrame> frames_;
  std::deque<features::FrameFeatures> features_;
};

/// What the 2D panel shows of one frame. Images and features may be missing (null).
struct LiveFrame {
  const messages::CompressedFrame* frame = nullptr;
  const features::FrameFeatures* features = nullptr;
  const tracking::PoseEstimate* pose = nullptr;
};

/// Makes packets "live": colour image without lens distortion, depth in false colours, features.
class LiveView {
 public:
  std::vector<std::uint8_t> packet(const LiveFrame& live, const DirectionColours& colours);

 private:
  image::Rectifier rectifier_;
};

}  // namespace eg::services
