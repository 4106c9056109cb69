#include "services/procman_deputy/deputy_service.hpp"

#include <spdlog/spdlog.h>

#include "common/base/printable.hpp"
#include "common/procman/guardian.hpp"

namespace eg::procman_deputy {
namespace {

using procman::channels::kDiscover;
using procman::channels::kInfo;
using procman::channels::kOrders;
using procman::channels::kPrintf;

constexpr std::chrono::milliseconds kStep{10};

procman::Now now() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return {procman::Clock::now(), std::chrono::duration_cast<std::chrono::microseconds>(since_epoch).count()};
}

/// What the deputy itself says, it says here too.
void log_own_words(const procman::Printf& message) {
  if (message.sheriff_id != 0) return;
  spdlog::info("{}", base::printable(message.text.substr(0, message.text.find('\n'))));
}

}  // namespace

DeputyService::DeputyService(transport::Bus& bus, procman::Deputy::Options options)
    : bus_(bus),
      deputy_(std::move(options),
              {[this](const procman::Info& info) { publish(kInfo, info); },
               [this](const procman::Printf& text) {
                 log_own_words(text);
                 publish(kPrintf, text);
               },
               [this](const procman::Discovery& discovery) { publish(kDiscover, discovery); }},
              now()) {}

base::Status DeputyService::subscribe() {
  if (const auto status = subscribe<procman::Orders>(kOrders); !status) return status;
  if (const auto status = subscribe<procman::Info>(kInfo); !status) return status;
  return subscribe<procman::Discovery>(kDiscover);
}

int DeputyService::run(const std::function<int()>& stop_count) {
  base::Status status;
  while (status && stop_count() == 0 && !deputy_.conflict()) status = step();
  deputy_.shut_down();
  while (status && deputy_.busy() && stop_count() < procman::kStopAtOnce) status = step();
  deputy_.kill_everything();
  if (const auto& conflict = deputy_.conflict()) {
    spdlog::error(conflict->reason);
    return conflict->exit_code;
  }
  if (!status) spdlog::error(status.error().message);
  return status ? 0 : 1;
}

base::Status DeputyService::step() {
  const int stops = procman::stop_count();
  const auto handled = bus_.handle(kStep);
  deputy_.step(now(), std::chrono::milliseconds(0));
  const bool interrupted = procman::stop_count() > stops;  // by a signal, which LCM takes for an error
  if (!handled && !interrupted) return tl::make_unexpected(handled.error());
  return {};
}

template <typename Message>
base::Status DeputyService::subscribe(const char* channel) {
  constexpr int kQueue = 30;
  return bus_.subscribe(
      channel,
      [this, channel](const transport::ReceivedMessage& received) {
        const auto message = procman::decode<Message>(received.bytes);
        if (message) {
          deputy_.handle(*message, now());
        } else {
          spdlog::warn("a message on {} is ignored: {}", channel, message.error().message);
        }
      },
      kQueue);
}

template <typename Message>
void DeputyService::publish(const char* channel, const Message& message) {
  if (const auto sent = bus_.publish(channel, procman::encode(message)); !sent) spdlog::warn(sent.error().message);
}

}  // namespace eg::procman_deputy
