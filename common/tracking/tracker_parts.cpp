#include "common/tracking/tracker_parts.hpp"

#include <vector>

namespace eg::tracking {

features::FrameFeatures without_missing(features::FrameFeatures frame, const TrackerParts& parts) {
  if (!parts.lines) frame.lines.clear();
  if (!parts.planes) frame.planes.clear();
  std::erase_if(frame.directions, [&](const features::DirectionFeature& direction) {
    return direction.kind == features::DirectionKind::plane_normal ? !parts.planes : !parts.lines;
  });
  for (features::LineFeature& line : frame.lines) {
    if (!parts.planes) line.direction = -1;  // the directions were counted with those of the planes
  }
  return frame;
}

}  // namespace eg::tracking
