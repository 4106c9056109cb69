#include <spdlog/spdlog.h>

#include "common/service/service.hpp"

namespace eg::service {

ServiceContext::ServiceContext(transport::Bus& bus, ServiceOptions options)
    : bus_(bus), options_(std::move(options)), status_(options_.name) {}

void ServiceContext::rename(const std::string& name) {
  options_.name = name;
  status_.set_service(name);
}

void ServiceContext::publish_bytes(const char* channel, const messages::Bytes& bytes) {
  const base::Status sent = bus_.publish(channel, bytes);
  if (!sent) status_.count_rejected(std::string(channel) + " could not be sent: " + sent.error().message);
}

void ServiceContext::subscribe_bytes(const char* channel, int queue_capacity,
                                     std::function<void(messages::ByteView)> handler) {
  const base::Status subscribed = bus_.subscribe(
      channel, [handler = std::move(handler)](const transport::ReceivedMessage& message) { handler(message.bytes); },
      queue_capacity);
  // A bus that cannot subscribe is gone, and its next handle() ends the service; here it is enough to say so.
  if (!subscribed) spdlog::error("cannot subscribe to {}: {}", channel, subscribed.error().message);
}

}  // namespace eg::service
