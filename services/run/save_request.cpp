#include "services/run/save_request.hpp"

#include "common/messages/channels.hpp"

namespace eg::run {
namespace {

constexpr std::chrono::milliseconds kAskAgain{500};

}  // namespace

SaveRequest::SaveRequest(service::ServiceContext& context, std::int64_t request_id)
    : context_(context), request_id_(request_id) {
  context.subscribe<messages::ControlReply>(
      messages::channels::kControlReply, service::kSmallQueue, [this](const messages::ControlReply& reply) {
        if (reply.request_id != request_id_ || waiting_for_.erase(reply.service) == 0) return;
        if (!reply.ok) failures_[reply.service] = reply.message;
      });
}

void SaveRequest::start(const std::set<std::string>& services, Clock::time_point now) {
  waiting_for_ = services;
  next_ask_ = now;
  update(now);
}

void SaveRequest::update(Clock::time_point now) {
  if (done() || now < next_ask_) return;
  next_ask_ = now + kAskAgain;
  // One question for all: each service answers by its own name.
  context_.publish(messages::channels::kControl, messages::Control{request_id_, messages::Command::save, ""});
}

}  // namespace eg::run
