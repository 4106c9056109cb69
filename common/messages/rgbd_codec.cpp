#include <egraph_msgs/rgbd_t.hpp>

#include "common/codec/colour_codec.hpp"
#include "common/codec/depth_codec.hpp"
#include "common/messages/codec.hpp"
#include "common/messages/guard.hpp"
#include "common/messages/wire.hpp"
#include "common/messages/wire_geometry.hpp"

namespace eg::messages {
namespace {

using Wire = egraph_msgs::rgbd_t;

base::Error in_field(const char* field, const base::Error& error) {
  return {"field '" + std::string(field) + "' is wrong: " + error.message};
}

base::Result<CompressedFrame> decode_frame(ByteView bytes) {
  auto wire =
      decode_wire<Wire>(bytes, {{"num_colour_bytes", kMaxImageBytes, 1}, {"num_depth_bytes", kMaxImageBytes, 1}},
                        {{"camera_name", kMaxName}});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  CompressedFrame frame;
  frame.header = read(wire->header, path("header"), check);
  frame.camera = read(wire->camera, wire->camera_name, path("camera"), check);
  frame.colour_encoding = read_enum(wire->colour_encoding, codec::ColourEncoding::png, path("colour_encoding"), check);
  check.in_range(path("depth_encoding"), wire->depth_encoding, Wire::DEPTH_DELTA_ZSTD, Wire::DEPTH_DELTA_ZSTD);
  frame.colour = std::move(wire->colour_data);
  frame.depth = std::move(wire->depth_data);
  return checked(std::move(frame), check);
}

}  // namespace

CompressedFrame compress(const image::RgbdFrame& frame, const RgbdEncoding& encoding) {
  const cv::Size size(frame.camera.width, frame.camera.height);
  EG_CHECK(frame.colour.size() == size && frame.depth.size() == size, "images have the size of their camera");
  return {frame.header, frame.camera, encoding.colour,
          codec::encode_colour(frame.colour, encoding.colour, encoding.jpeg_quality), codec::encode_depth(frame.depth)};
}

base::Result<image::RgbdFrame> decompress(const CompressedFrame& frame) {
  const geometry::CameraModel& camera = frame.camera;
  auto colour = codec::decode_colour(frame.colour, frame.colour_encoding, camera.width, camera.height);
  if (!colour) return tl::make_unexpected(in_field("colour_data", colour.error()));
  auto depth = codec::decode_depth(frame.depth, camera.width, camera.height);
  if (!depth) return tl::make_unexpected(in_field("depth_data", depth.error()));
  return image::RgbdFrame{frame.header, camera, std::move(*colour), std::move(*depth)};
}

Bytes encode(const image::RgbdFrame& frame) { return encode(compress(frame)); }

Bytes encode(const CompressedFrame& frame) {
  Wire wire{};
  wire.header = write(frame.header);
  wire.camera = write(frame.camera);
  wire.camera_name = printable(frame.camera.name, kMaxName);
  wire.colour_encoding = static_cast<std::int8_t>(frame.colour_encoding);
  wire.depth_encoding = Wire::DEPTH_DELTA_ZSTD;
  wire.colour_data = frame.colour;
  wire.depth_data = frame.depth;
  wire.num_colour_bytes = static_cast<std::int32_t>(wire.colour_data.size());
  wire.num_depth_bytes = static_cast<std::int32_t>(wire.depth_data.size());
  return encode_wire(wire);
}

template <>
base::Result<CompressedFrame> decode(ByteView bytes) {
  return guarded<CompressedFrame>([&] { return decode_frame(bytes); });
}

template <>
base::Result<image::RgbdFrame> decode(ByteView bytes) {
  return guarded<image::RgbdFrame>([&] { return decode_frame(bytes).and_then(decompress); });
}

}  // namespace eg::messages
