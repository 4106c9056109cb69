#include "tests/bench/robots/played_robot.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "common/messages/channels.hpp"

namespace eg::bench {
namespace {

constexpr std::chrono::microseconds kFramePeriod{33'333};
constexpr std::chrono::milliseconds kAnnouncementPeriod{300};  // as the tracker's

}  // namespace

PlayedRobot::PlayedRobot(transport::Bus& bus, std::string prefix, const RecordedRobot& recorded,
                         Clock::time_point start)
    : bus_(bus, std::move(prefix)), recorded_(recorded), start_(start), next_frame_(start) {
  const auto subscribed = bus_.subscribe(
      messages::channels::kGraphUpdate, [this](const transport::ReceivedMessage& message) { on_update(message.bytes); },
      0);
  if (!subscribed) spdlog::error("{}", subscribed.error().message);
}

void PlayedRobot::step(Clock::time_point now) {
  for (; now >= next_frame_; next_frame_ += kFramePeriod) {
    for (const RecordedRobot::Stream& stream : recorded_.streams) {
      send(stream.channel.c_str(), messages::Bytes(stream.bytes, 0x55));
    }
  }
  const auto& all = recorded_.announcements;
  for (; next_ < all.size() && now >= start_ + all[next_].when; ++next_) {
    waiting_.push_back({&all[next_], now, now});
    send(messages::channels::kKeyframe, all[next_].message);
  }
  if (waiting_.empty() || now - waiting_.front().last_sent < kAnnouncementPeriod) return;
  waiting_.front().last_sent = now;
  ++repeated_;
  send(messages::channels::kKeyframe, waiting_.front().announcement->message);
}

void PlayedRobot::on_update(messages::ByteView bytes) {
  const auto update = messages::decode<egraph::GraphUpdate>(bytes);
  if (!update) return spdlog::error("{}", update.error().message);
  const auto answered = std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& waiting) {
    return waiting.announcement->keyframe == update->keyframe.id.value;
  });
  if (answered == waiting_.end()) return;
  answers_ms_.push_back(std::chrono::duration<double, std::milli>(Clock::now() - answered->first_sent).count());
  waiting_.erase(answered);
}

void PlayedRobot::send(const char* channel, messages::ByteView bytes) {
  if (const auto sent = bus_.publish(channel, bytes); !sent) spdlog::error("{}", sent.error().message);
}

}  // namespace eg::bench
