#include "services/relay/relay.hpp"

#include <set>

#include "common/messages/channels.hpp"

namespace eg::relay {
namespace {

constexpr int kQueue = 256;  // messages of one channel that may wait while others pass

}  // namespace

Channels default_channels() {
  using namespace messages::channels;
  return {{kPose, kKeyframe, kPoseCorrection, kKeyframeFeatures, kGraphRequest, kRestore, kMeshChunk, kEndOfStream,
           kStatus, "POSE_BODY"},
          {kGraphUpdate, kGraphSnapshot, kRestoreRequest, kResend, kMeshRequest}};
}

base::Status validate(const Channels& channels) {
  std::set<std::string> seen;
  for (const auto* const direction : {&channels.out, &channels.in}) {
    for (const std::string& channel : *direction) {
      if (!seen.insert(channel).second) {
        return base::fail("channel " + channel + " is there twice: each passes once, in one direction");
      }
    }
  }
  return {};
}

base::Status Relay::start(const Channels& channels) {
  if (const auto valid = validate(channels); !valid) return valid;
  for (const std::string& channel : channels.out) {
    if (const auto passing = pass(own_, shared_, channel); !passing) return passing;
  }
  for (const std::string& channel : channels.in) {
    if (const auto passing = pass(shared_, own_, channel); !passing) return passing;
  }
  return {};
}

base::Status Relay::pass(transport::Bus& from, transport::Bus& to, const std::string& channel) {
  const auto pass_on = [this, &to, channel](const transport::ReceivedMessage& message) {
    if (!to.publish(channel, message.bytes)) {
      ++lost_;
      return;
    }
    Traffic& traffic = traffic_[channel];
    ++traffic.messages;
    traffic.bytes += static_cast<std::int64_t>(message.bytes.size());
  };
  return from.subscribe(channel, pass_on, kQueue);
}

base::Status Relay::step(std::chrono::milliseconds timeout) {
  for (transport::Bus* const bus : {&own_, &shared_}) {
    if (const auto handled = bus->handle(timeout); !handled) return tl::make_unexpected(handled.error());
  }
  return {};
}

}  // namespace eg::relay
