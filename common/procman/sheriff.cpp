#include "common/procman/sheriff.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <charconv>
#include <optional>

namespace eg::procman {
namespace {

using namespace std::chrono_literals;

constexpr auto kPeriod = 1s;
constexpr auto kListeningTime = 1200ms;  ///< another sheriff speaks within a period
constexpr auto kStaleAfter = 30s;
/// Of those that the configuration does not name: whoever is on the network can claim to be one.
constexpr std::size_t kMostStrangers = 256;

/// The time in "host:pid:utime".
std::optional<std::int64_t> start_of(std::string_view sheriff) {
  const std::string_view digits = sheriff.substr(sheriff.rfind(':') + 1);
  std::int64_t utime = 0;
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), utime);
  if (parsed.ec != std::errc{} || parsed.ptr != digits.data() + digits.size()) return std::nullopt;
  return utime;
}

bool is_older(const std::string& sheriff, const std::string& than) {
  const auto start = start_of(sheriff);
  const auto other = start_of(than);
  if (!start || !other || *start == *other) return sheriff < than;
  return *start < *other;
}

/// Any other number is another run; where it began, a deputy may have said.
std::int32_t number_of_next_run(std::int32_t run) { return run == INT32_MAX ? 1 : run + 1; }

bool ended_as_asked(const OrderedCommand& order, int wait_status) {
  const int stop_signal = to_command(order.definition, "").stop_signal;
  return order.force_quit && WIFSIGNALED(wait_status) && WTERMSIG(wait_status) == stop_signal;
}

CommandStatus status_of(const OrderedCommand& order, const ReportedCommand& report) {
  const bool same_run = report.actual_runid == order.desired_runid;
  if (report.pid > 0) {
    if (order.force_quit) return CommandStatus::stopping;
    return same_run ? CommandStatus::running : CommandStatus::restarting;
  }
  if (!same_run && !order.force_quit) return CommandStatus::starting;
  const bool well = report.exit_code == 0 || ended_as_asked(order, report.exit_code);
  return well ? CommandStatus::stopped_ok : CommandStatus::stopped_error;
}

const ReportedCommand* find_report(const Info& info, std::int32_t sheriff_id) {
  const auto found = std::find_if(info.commands.begin(), info.commands.end(),
                                  [&](const ReportedCommand& report) { return report.sheriff_id == sheriff_id; });
  return found == info.commands.end() ? nullptr : &*found;
}

}  // namespace

const char* to_string(CommandStatus status) {
  switch (status) {
    case CommandStatus::unknown:
      return "Unknown";
    case CommandStatus::starting:
      return "Starting";
    case CommandStatus::running:
      return "Running";
    case CommandStatus::restarting:
      return "Restarting";
    case CommandStatus::stopping:
      return "Stopping";
    case CommandStatus::removing:
      return "Removing";
    case CommandStatus::stopped_ok:
      return "Stopped (OK)";
    case CommandStatus::stopped_error:
      return "Stopped (Error)";
  }
  return "Unknown";
}

Sheriff::Sheriff(const Configuration& configuration, const Options& options, Now now)
    : configuration_(configuration),
      name_(options.name),
      wishes_(configuration.commands.size(), Wish::none),
      listens_until_(now.time + kListeningTime),
      next_orders_(listens_until_),
      now_(now) {
  base::Random random(options.seed);
  for (const Command& command : configuration.commands) {
    OrderedCommand& order = orders_.emplace_back();
    order.definition = to_definition(command);
    order.sheriff_id = 1 + random.index(INT32_MAX - 1);  // 0 is the deputy itself
  }
}

std::string Sheriff::host_of(const Command& command) { return command.host.empty() ? "localhost" : command.host; }

void Sheriff::start(std::size_t command) { wish(command, Wish::start); }
void Sheriff::stop(std::size_t command) { wish(command, Wish::stop); }
void Sheriff::restart(std::size_t command) { wish(command, Wish::restart); }

void Sheriff::wish(std::size_t command, Wish wish) {
  if (!deputies_.contains(host_of(configuration_.commands[command]))) {
    wishes_[command] = wish;
    return;
  }
  OrderedCommand& order = orders_[command];
  const OrderedCommand before = order;
  const CommandStatus now = status(command, now_);
  const bool up = now == CommandStatus::running || now == CommandStatus::starting || now == CommandStatus::restarting;
  order.force_quit = wish == Wish::stop;
  if (wish == Wish::restart || (wish == Wish::start && !up)) {
    order.desired_runid = number_of_next_run(order.desired_runid);
  }
  changed_ |= order != before;
}

Condition Sheriff::condition(std::size_t command) const {
  switch (status(command, now_)) {
    case CommandStatus::running:
      return Condition::running;
    case CommandStatus::stopped_ok:
      return orders_[command].desired_runid == 0 ? Condition::not_started : Condition::ended_well;
    case CommandStatus::stopped_error:
      return Condition::failed;
    default:
      return Condition::changing;
  }
}

void Sheriff::handle(const Info& info, Now now) {
  now_ = now;
  if (!deputies_.contains(info.host) && !names_host(info.host) && deputies_.size() >= kMostStrangers) return;
  const auto [deputy, is_new] = deputies_.try_emplace(info.host);
  if (!is_new) notice_new_deputy(deputy->second, info);
  deputy->second = {info, now.time};
  if (is_new) take_over(info);
}

void Sheriff::handle(const Orders& orders, Now now) {
  now_ = now;
  if (orders.sheriff_name == name_ || !names_host(orders.host)) return;
  const bool was_there = now.time < listens_until_ || is_older(orders.sheriff_name, name_);
  (was_there ? superior_ : intruder_) = orders.sheriff_name;
}

/// At first hearing: what the deputy runs already need not be started.
void Sheriff::take_over(const Info& info) {
  std::vector<std::int32_t> taken;
  for (std::size_t i = 0; i < orders_.size(); ++i) {
    if (host_of(configuration_.commands[i]) != info.host) continue;
    const auto same = [&](const ReportedCommand& report) {
      return report.definition == orders_[i].definition &&
             std::find(taken.begin(), taken.end(), report.sheriff_id) == taken.end();
    };
    const auto report = std::find_if(info.commands.begin(), info.commands.end(), same);
    if (report != info.commands.end()) {
      taken.push_back(report->sheriff_id);
      orders_[i].sheriff_id = report->sheriff_id;
      orders_[i].desired_runid = report->actual_runid;
    }
    if (wishes_[i] != Wish::none) wish(i, std::exchange(wishes_[i], Wish::none));
  }
  changed_ = true;
}

/// A deputy that was started anew has forgotten everything. What runs it starts again, but what had ended must not run
/// a second time.
void Sheriff::notice_new_deputy(const DeputyState& before, const Info& info) {
  for (std::size_t i = 0; i < orders_.size(); ++i) {
    const ReportedCommand* report = find_report(before.info, orders_[i].sheriff_id);
    const bool had_ended = report != nullptr && report->pid == 0 && !orders_[i].definition.auto_respawn &&
                           report->actual_runid == orders_[i].desired_runid;
    const bool forgotten = find_report(info, orders_[i].sheriff_id) == nullptr;
    if (had_ended && forgotten && before.info.host == host_of(configuration_.commands[i])) {
      orders_[i].desired_runid = 0;
    }
  }
}

std::vector<Orders> Sheriff::take_orders(Now now) {
  now_ = now;
  std::vector<Orders> due;
  if (now.time < listens_until_ || (now.time < next_orders_ && !changed_)) return due;
  next_orders_ = now.time + kPeriod;
  changed_ = false;
  for (const auto& [host, deputy] : deputies_) {
    if (names_host(host)) due.push_back(make_orders(host, now));
  }
  return due;
}

Orders Sheriff::make_orders(const std::string& host, Now now) const {
  Orders orders;
  orders.utime = now.utime;
  orders.host = host;
  orders.sheriff_name = name_;
  for (std::size_t i = 0; i < orders_.size(); ++i) {
    if (host_of(configuration_.commands[i]) == host) orders.commands.push_back(orders_[i]);
  }
  return orders;
}

bool Sheriff::names_host(const std::string& host) const {
  return std::any_of(configuration_.commands.begin(), configuration_.commands.end(),
                     [&](const Command& command) { return host_of(command) == host; });
}

bool Sheriff::is_stale(const std::string& host, Now now) const {
  const auto deputy = deputies_.find(host);
  return deputy == deputies_.end() || now.time - deputy->second.heard > kStaleAfter;
}

CommandStatus Sheriff::status(std::size_t command, Now now) const {
  if (is_stale(host_of(configuration_.commands[command]), now)) return CommandStatus::unknown;
  const OrderedCommand& order = orders_[command];
  if (const ReportedCommand* reported = report(command)) return status_of(order, *reported);
  return order.desired_runid > 0 && !order.force_quit ? CommandStatus::starting : CommandStatus::unknown;
}

const ReportedCommand* Sheriff::report(std::size_t command) const {
  const auto deputy = deputies_.find(host_of(configuration_.commands[command]));
  return deputy == deputies_.end() ? nullptr : find_report(deputy->second.info, orders_[command].sheriff_id);
}

std::size_t Sheriff::find(std::int32_t sheriff_id) const {
  const auto found = std::find_if(orders_.begin(), orders_.end(),
                                  [&](const OrderedCommand& order) { return order.sheriff_id == sheriff_id; });
  return static_cast<std::size_t>(found - orders_.begin());
}

}  // namespace eg::procman
