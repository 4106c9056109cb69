#include "common/transport/lcm_bus.hpp"

#include <lcm/lcm.h>

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include "common/base/check.hpp"
#include "common/transport/channel_prefix.hpp"
#include "common/transport/machine_fence.hpp"

namespace eg::transport {
namespace {

struct LcmDestroyer {
  void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
};

/// LCM 1.3.1 lets one message more wait than it is told, and takes 0 for no bound.
int lcm_capacity(int queue_capacity) { return queue_capacity > 0 ? std::max(1, queue_capacity - 1) : 0; }

class LcmBusImplementation : public LcmBus {
 public:
  LcmBusImplementation(lcm_t* lcm, const Options& options)
      : lcm_(lcm), url_(options.url), prefix_(options.channel_prefix), fence_(options.only_this_machine) {}

  base::Status publish(std::string_view channel, std::span<const std::uint8_t> bytes) override;
  base::Status subscribe(const std::string& channel, Handler handler, int queue_capacity) override;
  base::Result<int> handle(std::chrono::milliseconds timeout) override;

 private:
  struct Subscription {
    LcmBusImplementation* bus;
    Handler handler;
  };

  static void on_message(const lcm_recv_buf_t* received, const char* name, void* subscription);
  void dispatch(const Subscription& subscription, const ReceivedMessage& message);
  base::Result<bool> handle_one(std::chrono::milliseconds timeout);

  // The C library holds pointers to the subscriptions: it goes first.
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::unique_ptr<lcm_t, LcmDestroyer> lcm_;
  std::string url_;
  ChannelPrefix prefix_;
  std::exception_ptr handler_exception_;  // on its way through the C library
  int handled_ = 0;                       // since handle() began
  bool fence_ = false;  // still to be put up: LCM opens its receiving socket with the first subscription
  bool handling_ = false;
};

base::Status LcmBusImplementation::publish(std::string_view channel, std::span<const std::uint8_t> bytes) {
  const auto name = prefix_.add(channel);
  if (!name) return tl::make_unexpected(name.error());
  if (bytes.size() > kMaxMessageBytes) {
    return base::fail("a message of " + std::to_string(bytes.size()) + " bytes is too large for channel " + *name);
  }
  if (lcm_publish(lcm_.get(), name->c_str(), bytes.data(), static_cast<unsigned>(bytes.size())) != 0) {
    return base::fail("cannot send " + std::to_string(bytes.size()) + " bytes on channel " + *name + " over " + url_);
  }
  return {};
}

base::Status LcmBusImplementation::subscribe(const std::string& channel, Handler handler, int queue_capacity) {
  EG_CHECK(!handling_, "a handler does not subscribe: LCM's list of subscriptions is in use");
  const auto name = prefix_.add(channel);
  if (!name) return tl::make_unexpected(name.error());
  subscriptions_.push_back(std::make_unique<Subscription>(Subscription{this, std::move(handler)}));
  // LCM takes a regular expression; of the characters that a channel name may have, only the dot needs an escape.
  std::string pattern;
  for (const char c : *name) pattern += c == '.' ? std::string("\\.") : std::string(1, c);
  lcm_subscription_t* subscription =
      lcm_subscribe(lcm_.get(), pattern.c_str(), &LcmBusImplementation::on_message, subscriptions_.back().get());
  if (subscription == nullptr) {
    subscriptions_.pop_back();
    return base::fail("cannot listen to channel " + *name + " over " + url_);
  }
  lcm_subscription_set_queue_capacity(subscription, lcm_capacity(queue_capacity));
  const auto port = udp_port(url_);
  if (!port || !std::exchange(fence_, false)) return {};
  return drop_datagrams_of_other_machines(*port);
}

base::Result<int> LcmBusImplementation::handle(std::chrono::milliseconds timeout) {
  using Clock = std::chrono::steady_clock;
  EG_CHECK(!handling_, "a handler does not call handle()");
  handled_ = 0;
  const auto end = Clock::now() + timeout;
  auto wait = timeout;
  do {
    const auto any = handle_one(wait);
    if (!any) return tl::make_unexpected(any.error());
    if (!*any) break;
    wait = std::chrono::milliseconds(0);
  } while (Clock::now() < end);
  return handled_;
}

/// Whether a message came within `timeout`.
base::Result<bool> LcmBusImplementation::handle_one(std::chrono::milliseconds timeout) {
  handling_ = true;
  const int result = lcm_handle_timeout(lcm_.get(), static_cast<int>(timeout.count()));
  handling_ = false;
  if (handler_exception_) std::rethrow_exception(std::exchange(handler_exception_, nullptr));
  if (result < 0) return base::fail("the connection over " + url_ + " has ended");
  return result > 0;
}

void LcmBusImplementation::on_message(const lcm_recv_buf_t* received, const char* name, void* user) {
  const auto* subscription = static_cast<const Subscription*>(user);
  LcmBusImplementation& bus = *subscription->bus;
  bus.dispatch(*subscription, {bus.prefix_.remove(name),
                               {static_cast<const std::uint8_t*>(received->data), received->data_size},
                               received->recv_utime});
}

void LcmBusImplementation::dispatch(const Subscription& subscription, const ReceivedMessage& message) {
  ++handled_;
  try {
    subscription.handler(message);
  } catch (...) {
    if (!handler_exception_) handler_exception_ = std::current_exception();
  }
}

}  // namespace

base::Result<std::unique_ptr<LcmBus>> LcmBus::create(const Options& options) {
  if (const auto route = check_multicast_route(options.url); !route) return tl::make_unexpected(route.error());
  lcm_t* lcm = lcm_create(options.url.c_str());
  if (lcm == nullptr) {
    return base::fail("cannot open LCM at '" + options.url + "': the URL is wrong, or the port is taken");
  }
  return std::make_unique<LcmBusImplementation>(lcm, options);
}

}  // namespace eg::transport
