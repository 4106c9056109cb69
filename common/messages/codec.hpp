#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/result.hpp"
#include "common/codec/colour_codec.hpp"
#include "common/egraph/types.hpp"
#include "common/image/rgbd_frame.hpp"
#include "common/mapping/mesh.hpp"
#include "common/messages/control.hpp"
#include "common/tracking/pose_estimate.hpp"
#include "common/tracking/saved_map.hpp"

/// Domain types to message bytes and back. decode() accepts only what is whole, within bounds and finite; the error
/// names the field. No exception leaves it. The message types are in lcmtypes/, the rules in docs/messages.md.
///
/// What is decoded is bit for bit what was encoded, but for this: colour is as good as its encoding; of symmetric
/// matrices the upper triangle is sent; texts are cut to their bounds and control characters in them become spaces.
namespace eg::messages {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

struct RgbdEncoding {
  codec::ColourEncoding colour = codec::ColourEncoding::jpeg;
  int jpeg_quality = codec::kDefaultJpegQuality;  ///< 1 to 100
};

/// A frame whose images are still as the message carries them: to be stored, sent again or passed on without loss.
struct CompressedFrame {
  image::FrameHeader header;
  geometry::CameraModel camera;
  codec::ColourEncoding colour_encoding = codec::ColourEncoding::jpeg;
  Bytes colour;  ///< JPEG or PNG
  Bytes depth;   ///< codec::encode_depth()
};

CompressedFrame compress(const image::RgbdFrame& frame, const RgbdEncoding& encoding = {});
/// The error names the field whose content is no image of the camera's size.
base::Result<image::RgbdFrame> decompress(const CompressedFrame& frame);

Bytes encode(const image::RgbdFrame& frame);  ///< as encode(compress(frame))
Bytes encode(const CompressedFrame& frame);
Bytes encode(const features::FrameFeatures& features);
Bytes encode(const tracking::PoseEstimate& pose);
Bytes encode(const tracking::PoseCorrection& correction);
Bytes encode(const egraph::Keyframe& keyframe);
Bytes encode(const egraph::GraphUpdate& update);
Bytes encode(const egraph::GraphSnapshot& snapshot);
Bytes encode(const mapping::MeshChunk& chunk);
Bytes encode(const GraphRequest& request);
Bytes encode(const MeshRequest& request);
Bytes encode(const Acknowledge& acknowledge);
Bytes encode(const EndOfStream& end);
Bytes encode(const ResendRequest& request);
Bytes encode(const tracking::KeyframeLinks& links);
Bytes encode(const tracking::LandmarkPositions& landmarks);
Bytes encode(const Control& control);
Bytes encode(const ControlReply& reply);
Bytes encode(const ServiceStatus& status);

/// The header of a FEATURES message whatever is wrong with its features: to say which frame is refused.
base::Result<image::FrameHeader> decode_features_header(ByteView bytes);

/// T is any of the types above.
template <typename T>
base::Result<T> decode(ByteView bytes);

template <>
base::Result<image::RgbdFrame> decode(ByteView bytes);
template <>
base::Result<CompressedFrame> decode(ByteView bytes);
template <>
base::Result<features::FrameFeatures> decode(ByteView bytes);
template <>
base::Result<tracking::PoseEstimate> decode(ByteView bytes);
template <>
base::Result<tracking::PoseCorrection> decode(ByteView bytes);
template <>
base::Result<egraph::Keyframe> decode(ByteView bytes);
template <>
base::Result<egraph::GraphUpdate> decode(ByteView bytes);
template <>
base::Result<egraph::GraphSnapshot> decode(ByteView bytes);
template <>
base::Result<mapping::MeshChunk> decode(ByteView bytes);
template <>
base::Result<GraphRequest> decode(ByteView bytes);
template <>
base::Result<MeshRequest> decode(ByteView bytes);
template <>
base::Result<Acknowledge> decode(ByteView bytes);
template <>
base::Result<EndOfStream> decode(ByteView bytes);
template <>
base::Result<ResendRequest> decode(ByteView bytes);
template <>
base::Result<tracking::KeyframeLinks> decode(ByteView bytes);
template <>
base::Result<tracking::LandmarkPositions> decode(ByteView bytes);
template <>
base::Result<Control> decode(ByteView bytes);
template <>
base::Result<ControlReply> decode(ByteView bytes);
template <>
base::Result<ServiceStatus> decode(ByteView bytes);

}  // namespace eg::messages
