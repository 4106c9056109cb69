#include "common/service/service_loop.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/messages/channels.hpp"
#include "common/messages/service_state.hpp"

namespace eg::service {
namespace {

using std::chrono::duration_cast;
using std::chrono::microseconds;
using std::chrono::steady_clock;
using std::chrono::system_clock;

constexpr std::chrono::seconds kStatusPeriod{1};
constexpr std::size_t kRememberedReplies = 64;

template <typename Clock>
std::int64_t now_utime() {
  return duration_cast<microseconds>(Clock::now().time_since_epoch()).count();
}

}  // namespace

ServiceLoop::ServiceLoop(transport::Bus& bus, ServiceContext& context, Service& service)
    : bus_(bus), context_(context), service_(service), next_status_(steady_clock::now()) {
  context_.subscribe<messages::Control>(messages::channels::kControl, kSmallQueue,
                                        [this](const messages::Control& control) { handle_control(control); });
}

base::Status ServiceLoop::step(std::chrono::milliseconds timeout) {
  control_messages_ = 0;
  const base::Result<int> handled = bus_.handle(timeout);
  if (!handled) return base::fail(handled.error().message);
  if (*handled > control_messages_) saved_ = false;
  carry_out_requests();
  service_.idle(now_utime<steady_clock>());
  if (steady_clock::now() >= next_status_) publish_status();
  return {};
}

base::Status ServiceLoop::save() {
  if (saved_ || context_.options().out.empty()) return {};
  const base::Status status = service_.save();
  saved_ = status.has_value();
  return status;
}

void ServiceLoop::say_goodbye() {
  context_.status().set_state(messages::kEndedState);
  publish_status();
}

void ServiceLoop::handle_control(const messages::Control& control) {
  ++control_messages_;
  if (control.service.empty() || control.service == context_.options().name) requests_.push_back(control);
}

void ServiceLoop::carry_out_requests() {
  while (!requests_.empty()) {
    const messages::Control request = requests_.front();
    requests_.pop_front();
    const auto known = std::find_if(answered_.begin(), answered_.end(), [&](const messages::ControlReply& reply) {
      return reply.request_id == request.request_id;
    });
    if (known != answered_.end()) {
      context_.publish(messages::channels::kControlReply, *known);
      continue;
    }
    messages::ControlReply reply{request.request_id, context_.options().name, true, ""};
    if (const base::Status saved = save(); !saved) {
      reply.ok = false;
      reply.message = saved.error().message;
    }
    answered_.push_back(reply);
    if (answered_.size() > kRememberedReplies) answered_.pop_front();
    // The status goes out first: whoever waits for the reply then has the final figures.
    publish_status();
    context_.publish(messages::channels::kControlReply, reply);
    if (request.command == messages::Command::shutdown) shutdown_ = true;
  }
}

void ServiceLoop::publish_status() {
  const messages::ServiceStatus status = context_.status().status(now_utime<system_clock>());
  context_.publish(messages::channels::kStatus, status);
  if (status.rejected > reported_rejections_) {
    const std::string& robot = context_.options().robot;
    spdlog::warn("{}{} messages rejected so far, the last: {}", robot.empty() ? robot : robot + ": ", status.rejected,
                 status.last_rejection);
    reported_rejections_ = status.rejected;
  }
  next_status_ = steady_clock::now() + kStatusPeriod;
}

}  // namespace eg::service
