#include "services/run/run_monitor.hpp"

#include <algorithm>
#include <utility>

#include "common/messages/channels.hpp"
#include "common/messages/service_name.hpp"

namespace eg::run {
namespace {

std::int64_t whole_seconds(Clock::duration duration) {
  return std::chrono::duration_cast<std::chrono::seconds>(duration).count();
}

}  // namespace

RunMonitor::RunMonitor(service::ServiceContext& context, Options options, Clock::time_point now)
    : options_(std::move(options)), now_(now), last_progress_(now) {
  for (const std::string& consumer : options_.consumers) {
    acknowledged_[consumer] = -1;
    last_heard_[consumer] = now;
  }
  using namespace messages;
  context.subscribe<Acknowledge>(channels::kAcknowledge, service::kSmallQueue, [this](const Acknowledge& acknowledge) {
    hear_of(acknowledge.consumer);
    const auto known = acknowledged_.find(acknowledge.consumer);
    if (known == acknowledged_.end() || acknowledge.sequence <= known->second) return;
    known->second = acknowledge.sequence;
    last_progress_ = now_;
  });
  context.subscribe<tracking::PoseEstimate>(channels::kPose, service::kSmallQueue,
                                            [this](const tracking::PoseEstimate& pose) {
                                              if (!tracked_.insert(pose.header.sequence).second) return;
                                              poses_ += pose.has_pose ? 1 : 0;
                                              keyframes_ += pose.keyframe.valid() ? 1 : 0;
                                              tracking_state_ = tracking::to_string(pose.state);
                                              last_progress_ = now_;
                                            });
  context.subscribe<EndOfStream>(channels::kEndOfStream, service::kSmallQueue, [this](const EndOfStream& end) {
    if (!end_) last_progress_ = now_;
    end_ = end;
  });
  context.subscribe<ServiceStatus>(channels::kStatus, service::kSmallQueue, [this](const ServiceStatus& status) {
    hear_of(status.service);
    statuses_[status.service] = status;
    last_heard_[status.service] = now_;
  });
}

void RunMonitor::hear_of(const std::string& name) {
  for (const std::string& consumer : options_.consumers) {
    if (name == consumer || !messages::is_of_service(name, consumer)) continue;
    acknowledged_.erase(consumer);
    last_heard_.erase(consumer);
    acknowledged_.try_emplace(name, -1);
    last_heard_.try_emplace(name, now_);
  }
}

std::set<std::string> RunMonitor::names_of(const std::string& service) const {
  std::set<std::string> names;
  for (const auto& [name, time] : last_heard_) {
    if (messages::is_of_service(name, service)) names.insert(name);
  }
  return names.empty() ? std::set{service} : names;
}

void RunMonitor::update(Clock::time_point now) { now_ = now; }

std::int64_t RunMonitor::frames_done() const {
  if (!options_.lockstep) return static_cast<std::int64_t>(tracked_.size());
  return acknowledged_.at(slowest_consumer()) + 1;
}

std::int64_t RunMonitor::frames_skipped() const {
  return end_ ? static_cast<std::int64_t>(end_->skipped_utimes.size()) : 0;
}

bool RunMonitor::finished() const {
  if (!end_) return false;
  if (options_.lockstep && frames_done() >= end_->frame_count) return true;
  return now_ - last_progress_ > (options_.lockstep ? options_.lost_end : options_.idle_end);
}

std::optional<std::string> RunMonitor::stalled() const {
  const auto pause = now_ - last_progress_;
  if (finished() || pause < options_.stall) return std::nullopt;
  const std::string slowest = slowest_consumer();
  const std::string silent = longest_silent_service();
  return "no frame was finished for " + std::to_string(whole_seconds(pause)) + " s: " + slowest +
         " is waited for at frame " + std::to_string(acknowledged_.at(slowest) + 1) +
         ", and the longest silent service is " + silent + " (" +
         std::to_string(whole_seconds(now_ - last_heard_.at(silent))) + " s)";
}

std::string RunMonitor::slowest_consumer() const {
  return std::min_element(acknowledged_.begin(), acknowledged_.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

std::string RunMonitor::longest_silent_service() const {
  return std::min_element(last_heard_.begin(), last_heard_.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

}  // namespace eg::run
