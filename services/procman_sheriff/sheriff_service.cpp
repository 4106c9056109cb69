#include "services/procman_sheriff/sheriff_service.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <array>
#include <random>

#include "common/base/printable.hpp"
#include "common/procman/guardian.hpp"
#include "services/procman_sheriff/status_table.hpp"

namespace eg::procman_sheriff {
namespace {

using procman::CommandStatus;

constexpr std::chrono::milliseconds kStep{20};
constexpr std::chrono::seconds kShowPeriod{1};

procman::Now now() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return {procman::Clock::now(), std::chrono::duration_cast<std::chrono::microseconds>(since_epoch).count()};
}

/// "host:pid:utime", as libbot2 has it.
procman::Sheriff::Options make_identity(procman::Now start) {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  procman::Sheriff::Options identity;
  identity.name = std::string(host.data()) + ":" + std::to_string(getpid()) + ":" + std::to_string(start.utime);
  std::random_device device;
  identity.seed = (static_cast<std::uint64_t>(device()) << 32U) | device();
  return identity;
}

}  // namespace

SheriffService::SheriffService(transport::Bus& bus, const procman::Configuration& configuration,
                               const SheriffOptions& options)
    : bus_(bus),
      configuration_(configuration),
      options_(options),
      now_(now()),
      sheriff_(configuration, make_identity(now_), now_),
      shown_(configuration.commands.size(), CommandStatus::unknown),
      next_show_(now_.time),
      observing_(options.observe) {
  if (observing_) return;
  if (!options_.script.empty()) {
    script_.emplace(configuration_, sheriff_, options_.script, procman::ScriptRunner::Options{options_.wait_limit});
  } else {
    for (std::size_t i = 0; i < configuration_.commands.size(); ++i) sheriff_.start(i);
  }
}

base::Status SheriffService::subscribe() {
  using namespace procman::channels;
  const auto on_info = [this](const procman::Info& info) { sheriff_.handle(info, now_); };
  const auto on_orders = [this](const procman::Orders& orders) { sheriff_.handle(orders, now_); };
  const auto on_printf = [this](const procman::Printf& text) { print_output(text); };
  if (const auto status = subscribe<procman::Info>(kInfo, on_info); !status) return status;
  if (const auto status = subscribe<procman::Printf>(kPrintf, on_printf); !status) return status;
  if (const auto status = subscribe<procman::Orders>(kOrders, on_orders); !status) return status;
  publish(kDiscover, procman::Discovery{now_.utime, "", 0});
  return {};
}

base::Status SheriffService::run(const std::function<bool()>& stop) {
  while (!stop()) {
    if (const base::Status status = step(); !status && !stop()) return status;
    if (const base::Status status = carry_script_on(); !status) return status;
    const bool over = options_.on_script_complete == OnScriptComplete::exit && !script_ && !options_.script.empty();
    if (over) return {};
  }
  return {};
}

base::Status SheriffService::step() {
  const auto handled = bus_.handle(kStep);
  now_ = now();
  if (!handled) return tl::make_unexpected(handled.error());
  if (!observing_) {
    if (!sheriff_.superior().empty()) {
      return base::fail("another sheriff, " + base::printable(sheriff_.superior()) + ", orders these deputies already");
    }
    warn_of_intruder();
    send_orders();
  }
  note_changes();
  show();
  return {};
}

base::Status SheriffService::carry_script_on() {
  if (!script_) return {};
  if (base::Status status = script_->step(now_.time); !status) return status;
  if (!script_->done()) return {};
  script_.reset();
  send_orders();
  console_.print("[procman-sheriff] script \"" + options_.script + "\" is done");
  observing_ = options_.on_script_complete == OnScriptComplete::observe;
  return {};
}

void SheriffService::send_orders() {
  for (const procman::Orders& orders : sheriff_.take_orders(now_)) publish(procman::channels::kOrders, orders);
}

void SheriffService::show() {
  if (!console_.shows_tables() || now_.time < next_show_) return;
  next_show_ = now_.time + kShowPeriod;
  console_.show(make_status_table(configuration_, sheriff_, now_));
}

/// Where there is no table, a line for every change.
void SheriffService::note_changes() {
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    const CommandStatus status = sheriff_.status(i, now_);
    if (std::exchange(shown_[i], status) == status) continue;
    next_show_ = now_.time;
    if (!console_.shows_tables()) {
      console_.print("[procman-sheriff] " + configuration_.commands[i].name + ": " + to_string(status));
    }
  }
}

void SheriffService::print_output(const procman::Printf& text) {
  const std::size_t command = sheriff_.find(text.sheriff_id);
  const bool known = command < configuration_.commands.size();
  if (!known && text.sheriff_id != 0) return;  // of a command of somebody else
  const std::string& name = known ? configuration_.commands[command].name : text.deputy_name;
  output_[text.sheriff_id].add(
      text.text, [&](const std::string& line) { console_.print(base::printable(with_name(name, line))); });
}

void SheriffService::warn_of_intruder() {
  if (sheriff_.intruder() == intruder_warned_of_) return;
  intruder_warned_of_ = sheriff_.intruder();
  console_.print(base::printable("[procman-sheriff] warning: another sheriff, " + intruder_warned_of_ +
                                 ", orders these deputies, too: end one of the two"));
}

template <typename Message>
base::Status SheriffService::subscribe(const char* channel, std::function<void(const Message&)> handler) {
  constexpr int kQueue = 1000;  // output comes in bursts
  return bus_.subscribe(
      channel,
      [this, channel, handler = std::move(handler)](const transport::ReceivedMessage& received) {
        const auto message = procman::decode<Message>(received.bytes);
        if (message) {
          handler(*message);
        } else {
          console_.print("[procman-sheriff] warning: a message on " + std::string(channel) +
                         " is ignored: " + message.error().message);
        }
      },
      kQueue);
}

template <typename Message>
void SheriffService::publish(const char* channel, const Message& message) {
  const auto sent = bus_.publish(channel, procman::encode(message));
  if (!sent) console_.print("[procman-sheriff] warning: " + sent.error().message);
}

}  // namespace eg::procman_sheriff
