#include "common/transport/memory_bus.hpp"

#include <iterator>
#include <utility>

#include "common/base/check.hpp"

namespace eg::transport {

MemoryNetwork::MemoryNetwork(const Disturbance& disturbance) : disturbance_(disturbance), random_(disturbance.seed) {}

void MemoryNetwork::deliver(const std::string& name, std::span<const std::uint8_t> bytes) {
  const auto message =
      std::make_shared<const MemoryBus::Message>(MemoryBus::Message{name, {bytes.begin(), bytes.end()}, utime_});
  for (MemoryBus* bus : buses_) {
    if (random_.uniform() < disturbance_.loss) continue;
    const int copies = random_.uniform() < disturbance_.duplication ? 2 : 1;
    for (int copy = 0; copy < copies; ++copy) bus->enqueue(message, random_.uniform() < disturbance_.reordering);
  }
}

MemoryBus::MemoryBus(std::shared_ptr<MemoryNetwork> network, std::string channel_prefix)
    : network_(std::move(network)), prefix_(std::move(channel_prefix)) {
  EG_CHECK(network_ != nullptr, "a memory bus is attached to a network");
  network_->buses_.push_back(this);
}

MemoryBus::~MemoryBus() { std::erase(network_->buses_, this); }

base::Status MemoryBus::publish(std::string_view channel, std::span<const std::uint8_t> bytes) {
  const auto name = prefix_.add(channel);
  if (!name) return tl::make_unexpected(name.error());
  if (bytes.size() > kMaxMessageBytes) {
    return base::fail("a message of " + std::to_string(bytes.size()) + " bytes is too large for channel " + *name);
  }
  network_->deliver(*name, bytes);
  return {};
}

base::Status MemoryBus::subscribe(const std::string& channel, Handler handler, int queue_capacity) {
  auto name = prefix_.add(channel);
  if (!name) return tl::make_unexpected(name.error());
  subscriptions_.push_back({std::move(*name), std::move(handler), queue_capacity, 0});
  return {};
}

void MemoryBus::enqueue(const std::shared_ptr<const Message>& message, bool overtake) {
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    Subscription& subscription = subscriptions_[i];
    if (subscription.name != message->name) continue;
    if (subscription.capacity > 0 && subscription.waiting >= subscription.capacity) continue;
    ++subscription.waiting;
    waiting_.insert(overtake && !waiting_.empty() ? std::prev(waiting_.end()) : waiting_.end(), {i, message});
  }
}

base::Result<int> MemoryBus::handle(std::chrono::milliseconds /*timeout*/) {
  const int count = static_cast<int>(waiting_.size());
  for (int i = 0; i < count; ++i) {
    const Delivery delivery = std::move(waiting_.front());
    waiting_.pop_front();
    Subscription& subscription = subscriptions_[delivery.subscription];
    --subscription.waiting;
    subscription.handler({prefix_.remove(delivery.message->name), delivery.message->bytes, delivery.message->utime});
  }
  return count;
}

}  // namespace eg::transport
