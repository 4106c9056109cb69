#include "services/viewer/live_view.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "common/codec/colour_codec.hpp"
#include "common/codec/depth_codec.hpp"
#include "services/viewer/arrays.hpp"
#include "services/viewer/keyframe_contents.hpp"
#include "services/viewer/packet.hpp"

namespace eg::services {
namespace {

/// More than a tracker keeps waiting; 64 frames are 7 MB.
constexpr std::size_t kMaxRecent = 64;
constexpr int kDepthJpegQuality = 70;
constexpr int kDepthSide = 320;    ///< pixels; of the longer side
constexpr double kFarthest = 5.0;  ///< metres; what structured light measures well lies nearer

// Places in the colour map, whose ends are too dark to tell apart.
constexpr double kNearColour = 240.0;
constexpr double kFarColour = 20.0;

template <typename Queue, typename Item>
void add_newest(Queue& queue, const Item& item) {
  queue.push_back(item);
  if (queue.size() > kMaxRecent) queue.pop_front();
}

template <typename Queue>
auto* find_newest(const Queue& queue, const image::FrameHeader& header) {
  const auto found = std::find_if(queue.rbegin(), queue.rend(), [&](const auto& item) {
    return item.header.session == header.session && item.header.sequence == header.sequence;
  });
  return found == queue.rend() ? nullptr : &*found;
}

/// Near is red, far is blue, no reading is black.
std::vector<std::uint8_t> draw_depth(const cv::Mat& depth, double units_per_metre) {
  const int longer = std::max(depth.cols, depth.rows);
  const auto shrunk = [&](int side) { return std::max(1, side * kDepthSide / longer); };
  cv::Mat small;
  cv::resize(depth, small, {shrunk(depth.cols), shrunk(depth.rows)}, 0, 0, cv::INTER_NEAREST);
  cv::Mat nearness;
  small.convertTo(nearness, CV_8U, (kFarColour - kNearColour) / (kFarthest * units_per_metre), kNearColour);
  cv::Mat coloured;
  cv::applyColorMap(nearness, coloured, cv::COLORMAP_TURBO);
  coloured.setTo(cv::Scalar(0, 0, 0), small == 0);
  return codec::encode_colour(coloured, codec::ColourEncoding::jpeg, kDepthJpegQuality);
}

void add_image(Packet& packet, const messages::CompressedFrame& frame, image::Rectifier& rectifier) {
  auto depth = codec::decode_depth(frame.depth, frame.camera.width, frame.camera.height);
  if (!depth) return;  // the feature extractor has counted it
  const double units = frame.camera.depth_units_per_metre;
  if (!frame.camera.has_distortion()) {
    packet.set("width", frame.camera.width)
        .set("height", frame.camera.height)
        .array("colour", frame.colour)
        .array("depth", draw_depth(*depth, units));
    return;
  }
  auto colour = codec::decode_colour(frame.colour, frame.colour_encoding, frame.camera.width, frame.camera.height);
  if (!colour) return;
  const auto rectified = rectifier.rectify({frame.header, frame.camera, *colour, *depth});
  packet.set("width", rectified.camera.width)
      .set("height", rectified.camera.height)
      .array("colour", codec::encode_colour(rectified.colour, codec::ColourEncoding::jpeg))
      .array("depth", draw_depth(rectified.depth, 1.0));
}

void add_features(Packet& packet, const features::FrameFeatures& features, const std::vector<std::int32_t>& numbers,
                  const geometry::Pose& world_from_camera, const DirectionColours& colours) {
  std::vector<float> points, lines, corners;
  std::vector<std::uint8_t> point_has_depth;
  std::vector<std::int32_t> sizes, plane_numbers;
  for (const features::PointFeature& point : features.points) {
    append(points, point.pixel);
    point_has_depth.push_back(point.has_depth() ? 1 : 0);
  }
  for (const features::LineFeature& line : features.lines) {
    append(lines, line.start_pixel);
    append(lines, line.end_pixel);
  }
  for (const features::PlaneFeature& plane : features.planes) {
    std::int32_t visible = 0;
    for (const Eigen::Vector3d& corner : plane.hull) {
      if (corner.z() <= 0.0) continue;
      append(corners, features.camera.project(corner));
      ++visible;
    }
    sizes.push_back(visible);
    plane_numbers.push_back(colours.of(world_from_camera.rotation * plane.plane.normal));
  }
  packet.array("points", points)
      .array("point_has_depth", point_has_depth)
      .array("lines", lines)
      .array("line_colours", numbers)
      .array("plane_sizes", sizes)
      .array("plane_corners", corners)
      .array("plane_colours", plane_numbers);
}

}  // namespace

void RecentFrames::add(const messages::CompressedFrame& frame) { add_newest(frames_, frame); }

void RecentFrames::add(const features::FrameFeatures& features) { add_newest(features_, features); }

const messages::CompressedFrame* RecentFrames::find_frame(const image::FrameHeader& header) const {
  return find_newest(frames_, header);
}

const features::FrameFeatures* RecentFrames::find_features(const image::FrameHeader& header) const {
  return find_newest(features_, header);
}

std::vector<std::uint8_t> LiveView::packet(const LiveFrame& live, const DirectionColours& colours) {
  Packet packet("live");
  packet.set("sequence", static_cast<double>(live.pose->header.sequence));
  if (live.frame != nullptr) add_image(packet, *live.frame, rectifier_);
  if (live.features != nullptr) {
    const geometry::Pose& pose = live.pose->world_from_camera;
    add_features(packet, *live.features, line_colours(*live.features, pose, colours), pose, colours);
  }
  return packet.bytes();
}

}  // namespace eg::services
