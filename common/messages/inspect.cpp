#include "common/messages/inspect.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <egraph_msgs/acknowledge_t.hpp>
#include <egraph_msgs/control_reply_t.hpp>
#include <egraph_msgs/control_t.hpp>
#include <egraph_msgs/end_of_stream_t.hpp>
#include <egraph_msgs/features_t.hpp>
#include <egraph_msgs/graph_request_t.hpp>
#include <egraph_msgs/graph_snapshot_t.hpp>
#include <egraph_msgs/graph_update_t.hpp>
#include <egraph_msgs/keyframe_t.hpp>
#include <egraph_msgs/mesh_chunk_t.hpp>
#include <egraph_msgs/mesh_request_t.hpp>
#include <egraph_msgs/pose_correction_t.hpp>
#include <egraph_msgs/pose_estimate_t.hpp>
#include <egraph_msgs/resend_request_t.hpp>
#include <egraph_msgs/rgbd_t.hpp>
#include <egraph_msgs/service_status_t.hpp>

namespace eg::messages {
namespace {

constexpr std::size_t kFingerprintBytes = 8;

/// Of a frame, or what was derived from one.
template <typename T>
void describe(const T& value, MessageInfo& info) {
  if constexpr (requires { value.header; }) {
    info.session = value.header.session;
    info.number = value.header.sequence;
    info.utime = value.header.utime;
  } else if constexpr (requires { value.session; }) {
    info.session = value.session;
    if constexpr (requires { value.version; }) info.number = value.version;
  }
}

void describe(const egraph::Keyframe& keyframe, MessageInfo& info) {
  info.session = keyframe.header.session;
  info.number = keyframe.id.value;
  info.utime = keyframe.header.utime;
}

void describe(const egraph::GraphUpdate& update, MessageInfo& info) {
  info.session = update.session;
  info.number = update.version;
  info.utime = update.keyframe.utime;
}

/// Sent when somebody asks, of whatever version there is then.
void describe(const egraph::GraphSnapshot& snapshot, MessageInfo& info) { info.session = snapshot.session; }

void describe(const ServiceStatus& status, MessageInfo& info) { info.utime = status.utime; }

template <typename T>
void inspect_as(ByteView bytes, MessageInfo& info) {
  if (const auto value = decode<T>(bytes)) {
    describe(*value, info);
  } else {
    info.error = value.error().message;
  }
}

struct Type {
  std::int64_t fingerprint;
  const char* name;
  void (*inspect)(ByteView bytes, MessageInfo& info);
};

template <typename Wire, typename T>
Type type() {
  return {Wire::getHash(), Wire::getTypeName(), &inspect_as<T>};
}

/// Those that are on channels; the map archive's are in no log.
const std::array<Type, 16>& types() {
  static const std::array<Type, 16> kTypes = {type<egraph_msgs::rgbd_t, CompressedFrame>(),
                                              type<egraph_msgs::features_t, features::FrameFeatures>(),
                                              type<egraph_msgs::pose_estimate_t, tracking::PoseEstimate>(),
                                              type<egraph_msgs::pose_correction_t, tracking::PoseCorrection>(),
                                              type<egraph_msgs::keyframe_t, egraph::Keyframe>(),
                                              type<egraph_msgs::graph_update_t, egraph::GraphUpdate>(),
                                              type<egraph_msgs::graph_snapshot_t, egraph::GraphSnapshot>(),
                                              type<egraph_msgs::mesh_chunk_t, mapping::MeshChunk>(),
                                              type<egraph_msgs::mesh_request_t, MeshRequest>(),
                                              type<egraph_msgs::graph_request_t, GraphRequest>(),
                                              type<egraph_msgs::acknowledge_t, Acknowledge>(),
                                              type<egraph_msgs::end_of_stream_t, EndOfStream>(),
                                              type<egraph_msgs::resend_request_t, ResendRequest>(),
                                              type<egraph_msgs::control_t, Control>(),
                                              type<egraph_msgs::control_reply_t, ControlReply>(),
                                              type<egraph_msgs::service_status_t, ServiceStatus>()};
  return kTypes;
}

std::uint64_t fingerprint_of(ByteView bytes) {
  std::uint64_t fingerprint = 0;
  for (const std::uint8_t byte : bytes.first(kFingerprintBytes)) fingerprint = fingerprint << 8U | byte;
  return fingerprint;
}

}  // namespace

MessageInfo inspect(ByteView bytes) {
  MessageInfo info;
  if (bytes.size() < kFingerprintBytes) {
    info.type = "none";
    info.error = "the message is shorter than a fingerprint";
    return info;
  }
  const std::uint64_t fingerprint = fingerprint_of(bytes);
  const auto known = std::find_if(types().begin(), types().end(), [&](const Type& type) {
    return static_cast<std::uint64_t>(type.fingerprint) == fingerprint;
  });
  if (known != types().end()) {
    info.type = known->name;
    known->inspect(bytes, info);
  } else {
    std::array<char, 17> text{};
    std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(fingerprint));
    info.type = text.data();
  }
  return info;
}

}  // namespace eg::messages
