// Every message decoder against arbitrary bytes: the first byte chooses the type. The fingerprint is put right, else
// hardly an input would get past it. What is accepted must be encodable, and acceptable again.
#include <array>
#include <cstdint>
#include <cstdlib>

#include "common/messages/bot_images.hpp"
#include "common/messages/codec.hpp"

namespace {

using eg::messages::Bytes;
using eg::messages::ByteView;

constexpr std::size_t kFingerprintBytes = 8;

template <typename T>
T sample() {
  return {};
}

template <>
eg::image::RgbdFrame sample() {
  eg::image::RgbdFrame frame;
  frame.camera.width = frame.camera.height = 1;
  frame.colour = cv::Mat::zeros(1, 1, CV_8UC3);
  frame.depth = cv::Mat::zeros(1, 1, CV_16UC1);
  return frame;
}

template <typename T>
void decode_one(ByteView input) {
  static const Bytes kSample = eg::messages::encode(sample<T>());
  Bytes bytes(kSample.begin(), kSample.begin() + kFingerprintBytes);
  bytes.insert(bytes.end(), input.begin(), input.end());
  const auto value = eg::messages::decode<T>(bytes);
  if (value && !eg::messages::decode<T>(eg::messages::encode(*value))) std::abort();
}

/// A camera's images, which are received only.
void decode_camera(ByteView input) {
  static const eg::geometry::CameraModel kCamera = {"tiny", 16, 12, 20, 20, 7.5, 5.5, {}, 1000, 30};
  constexpr std::uint64_t kFingerprint = 0x20ba4f05e8f5e33a;
  Bytes bytes;
  for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(kFingerprint >> shift));
  bytes.insert(bytes.end(), input.begin(), input.end());
  const auto images = eg::messages::decode<eg::messages::bot::Images>(bytes);
  if (!images) return;
  const auto frame = eg::messages::bot::to_frame(*images, kCamera);
  if (frame && !eg::messages::decompress(*frame)) std::abort();
}

using Decoder = void (*)(ByteView);
constexpr std::array<Decoder, 19> kDecoders = {
    decode_one<eg::image::RgbdFrame>,
    decode_one<eg::features::FrameFeatures>,
    decode_one<eg::tracking::PoseEstimate>,
    decode_one<eg::tracking::PoseCorrection>,
    decode_one<eg::egraph::Keyframe>,
    decode_one<eg::egraph::GraphUpdate>,
    decode_one<eg::egraph::GraphSnapshot>,
    decode_one<eg::mapping::MeshChunk>,
    decode_one<eg::messages::GraphRequest>,
    decode_one<eg::messages::MeshRequest>,
    decode_one<eg::messages::Acknowledge>,
    decode_one<eg::messages::EndOfStream>,
    decode_one<eg::messages::Control>,
    decode_one<eg::messages::ControlReply>,
    decode_one<eg::messages::ServiceStatus>,
    decode_one<eg::messages::ResendRequest>,
    decode_one<eg::tracking::KeyframeLinks>,
    decode_one<eg::tracking::LandmarkPositions>,
    decode_camera,
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  kDecoders[data[0] % kDecoders.size()]({data + 1, size - 1});
  return 0;
}
