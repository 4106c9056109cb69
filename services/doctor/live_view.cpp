#include "services/doctor/live_view.hpp"

#include <algorithm>
#include <array>

#include "common/base/check.hpp"
#include "common/messages/channels.hpp"

namespace eg::doctor {
namespace {

namespace channels = messages::channels;

constexpr std::array kChannels = {channels::kRgbd,         channels::kFeatures,       channels::kKeyframeFeatures,
                                  channels::kPose,         channels::kKeyframe,       channels::kGraphUpdate,
                                  channels::kGraphRequest, channels::kGraphSnapshot,  channels::kRestoreRequest,
                                  channels::kRestore,      channels::kPoseCorrection, channels::kMeshChunk,
                                  channels::kMeshRequest,  channels::kStatus,         channels::kAcknowledge,
                                  channels::kEndOfStream,  channels::kControl,        channels::kControlReply,
                                  channels::kResend};

/// Input and output of a step of the pipeline; both carry the time of the frame that they are about.
struct Step {
  const char* from;
  const char* to;
};
constexpr std::array kSteps = {Step{channels::kRgbd, channels::kFeatures}, Step{channels::kFeatures, channels::kPose},
                               Step{channels::kRgbd, channels::kPose},
                               Step{channels::kKeyframe, channels::kGraphUpdate}};

constexpr int kQueue = 100;  // messages: three seconds of a camera, in case this machine is busy
constexpr double kMilliseconds = 1e-3;

}  // namespace

double ServiceView::cpu_percent() const {
  const double seconds = 1e-6 * static_cast<double>(latest.utime - first.utime);
  return seconds > 0.0 ? 100.0 * (latest.cpu_seconds - first.cpu_seconds) / seconds : 0.0;
}

LiveView::LiveView(transport::Bus& bus) {
  for (const char* channel : kChannels) {
    const auto subscribed = bus.subscribe(
        channel, [this](const transport::ReceivedMessage& message) { receive(message); }, kQueue);
    EG_CHECK(subscribed.has_value(), "the project's channel names are valid");
  }
}

void LiveView::receive(const transport::ReceivedMessage& message) {
  const messages::MessageInfo info = streams_.add(message.channel, message.bytes, message.receive_utime);
  if (!info.error.empty()) return;
  take_step_times(message, info);
  if (message.channel == channels::kStatus) take_status(message);
}

void LiveView::take_step_times(const transport::ReceivedMessage& message, const messages::MessageInfo& info) {
  if (!info.session || !info.utime) return;
  const auto arrival = [&](const std::string& channel) { return std::tuple(channel, *info.session, *info.utime); };
  if (!arrivals_.try_emplace(arrival(std::string(message.channel)), message.receive_utime).second) return;  // again
  for (const Step& step : kSteps) {
    if (message.channel != step.to) continue;
    const auto input = arrivals_.find(arrival(step.from));
    if (input == arrivals_.end()) continue;
    std::string name = step.from;
    name.append(" to ").append(step.to);
    steps_[name].add(kMilliseconds * static_cast<double>(message.receive_utime - input->second));
  }
}

void LiveView::take_status(const transport::ReceivedMessage& message) {
  const auto status = messages::decode<messages::ServiceStatus>(message.bytes);
  if (!status) return;
  std::string name = status->service;
  name.append(" on ").append(status->host).append(" (").append(std::to_string(status->pid)).append(")");
  const std::int64_t offset = message.receive_utime - status->utime;
  const auto [view, is_new] = services_.try_emplace(name, ServiceView{*status, *status, 0, offset});
  view->second.latest = *status;
  view->second.last_receive_utime = message.receive_utime;
  view->second.least_offset = std::min(view->second.least_offset, offset);
}

}  // namespace eg::doctor
