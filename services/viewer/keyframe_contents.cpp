#include "services/viewer/keyframe_contents.hpp"

#include "services/viewer/arrays.hpp"
#include "services/viewer/packet.hpp"

namespace eg::services {
namespace {

/// Neighbouring keyframes see the same points again; this many of each are enough for a dense picture.
constexpr std::size_t kMaxPoints = 400;
/// Points less certain than this would surround the surfaces as a haze.
constexpr double kMaxPointSigma = 0.1;  // metres

std::vector<float> points_of(const features::FrameFeatures& features) {
  std::vector<float> positions;
  for (const features::PointFeature& point : features.points) {  // the strongest first
    if (!point.has_depth() || point.depth_sigma > kMaxPointSigma) continue;
    append(positions, features.camera.unproject(point.pixel, point.depth));
    if (positions.size() >= 3 * kMaxPoints) break;
  }
  return positions;
}

}  // namespace

std::vector<std::int32_t> line_colours(const features::FrameFeatures& features, const geometry::Pose& world_from_camera,
                                       const DirectionColours& colours) {
  std::vector<std::int32_t> group_colours;
  for (const features::DirectionFeature& direction : features.directions) {
    group_colours.push_back(colours.of(world_from_camera.rotation * direction.direction));
  }
  std::vector<std::int32_t> numbers;
  for (const features::LineFeature& line : features.lines) {
    numbers.push_back(line.direction < 0 ? DirectionColours::kNone
                                         : group_colours[static_cast<std::size_t>(line.direction)]);
  }
  return numbers;
}

std::vector<std::uint8_t> contents_packet(egraph::KeyframeId id, const features::FrameFeatures& features,
                                          const geometry::Pose& world_from_camera, const DirectionColours& colours) {
  const std::vector<std::int32_t> numbers = line_colours(features, world_from_camera, colours);
  std::vector<float> lines;
  std::vector<std::int32_t> lifted_numbers;
  for (std::size_t i = 0; i < features.lines.size(); ++i) {
    const features::LineFeature& line = features.lines[i];
    if (!line.has_depth) continue;
    append(lines, line.start);
    append(lines, line.end);
    lifted_numbers.push_back(numbers[i]);
  }
  return Packet("contents")
      .set("keyframe", id.value)
      .array("points", points_of(features))
      .array("lines", lines)
      .array("line_colours", lifted_numbers)
      .bytes();
}

}  // namespace eg::services
