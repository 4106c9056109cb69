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

base::Result<image::RgbdFrame> decode_frame(ByteView bytes) {
  const auto wire =
      decode_wire<Wire>(bytes, {{"num_colour_bytes", kMaxImageBytes, 1}, {"num_depth_bytes", kMaxImageBytes, 1}},
                        {{"camera_name", kMaxName}});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  image::RgbdFrame frame;
  frame.header = read(wire->header, path("header"), check);
  frame.camera = read(wire->camera, wire->camera_name, path("camera"), check);
  const auto encoding = read_enum(wire->colour_encoding, codec::ColourEncoding::png, path("colour_encoding"), check);
  check.in_range(path("depth_encoding"), wire->depth_encoding, Wire::DEPTH_DELTA_ZSTD, Wire::DEPTH_DELTA_ZSTD);
  if (const auto status = check.status(); !status) return tl::make_unexpected(status.error());

  auto colour = codec::decode_colour(wire->colour_data, encoding, frame.camera.width, frame.camera.height);
  if (!colour) return tl::make_unexpected(in_field("colour_data", colour.error()));
  auto depth = codec::decode_depth(wire->depth_data, frame.camera.width, frame.camera.height);
  if (!depth) return tl::make_unexpected(in_field("depth_data", depth.error()));
  frame.colour = std::move(*colour);
  frame.depth = std::move(*depth);
  return frame;
}

}  // namespace

Bytes encode(const image::RgbdFrame& frame) { return encode(frame, RgbdEncoding{}); }

Bytes encode(const image::RgbdFrame& frame, const RgbdEncoding& encoding) {
  const cv::Size size(frame.camera.width, frame.camera.height);
  EG_CHECK(frame.colour.size() == size && frame.depth.size() == size, "images have the size of their camera");
  Wire wire{};
  wire.header = write(frame.header);
  wire.camera = write(frame.camera);
  wire.camera_name = printable(frame.camera.name, kMaxName);
  wire.colour_encoding = static_cast<std::int8_t>(encoding.colour);
  wire.depth_encoding = Wire::DEPTH_DELTA_ZSTD;
  wire.colour_data = codec::encode_colour(frame.colour, encoding.colour, encoding.jpeg_quality);
  wire.depth_data = codec::encode_depth(frame.depth);
  wire.num_colour_bytes = static_cast<std::int32_t>(wire.colour_data.size());
  wire.num_depth_bytes = static_cast<std::int32_t>(wire.depth_data.size());
  return encode_wire(wire);
}

template <>
base::Result<image::RgbdFrame> decode(ByteView bytes) {
  return guarded<image::RgbdFrame>([&] { return decode_frame(bytes); });
}

}  // namespace eg::messages
