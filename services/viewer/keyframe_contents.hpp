#pragma once

#include <cstdint>
#include <vector>

#include "common/egraph/types.hpp"
#include "common/features/features.hpp"
#include "services/viewer/direction_colours.hpp"

namespace eg::services {

/// The packet "contents" of a keyframe: its points and 3D lines in its own camera frame, so that a corrected pose moves
/// them without sending them again. Lines have the number of their group's direction.
std::vector<std::uint8_t> contents_packet(egraph::KeyframeId id, const features::FrameFeatures& features,
                                          const geometry::Pose& world_from_camera, const DirectionColours& colours);

/// The number of the direction of every line of the frame; DirectionColours::kNone for lines that belong to none.
std::vector<std::int32_t> line_colours(const features::FrameFeatures& features, const geometry::Pose& world_from_camera,
                                       const DirectionColours& colours);

}  // namespace eg::services
