#include "common/procman/deputy.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace eg::procman {
namespace {

using namespace std::chrono_literals;

constexpr auto kDiscoveryTime = 1500ms;
constexpr auto kDiscoveryPeriod = 200ms;
constexpr auto kReportPeriod = 1s;
constexpr std::int64_t kOldestOrders = 60'000'000;  ///< microseconds
/// Orders come at 1 Hz: two sheriffs heard within this time are both at work.
constexpr auto kSheriffMemory = 3s;
constexpr std::size_t kLongestText = 1023;  ///< bytes of a PRINTF
constexpr std::int32_t kDeputyItself = 0;   ///< instead of a sheriff_id

/// How much of `bytes` goes into one PRINTF: not ending amidst a UTF-8 character if that can be helped.
std::size_t text_size(std::string_view bytes) {
  if (bytes.size() <= kLongestText) return bytes.size();
  const auto continues = [&](std::size_t at) { return (static_cast<unsigned char>(bytes[at]) & 0xc0U) == 0x80U; };
  std::size_t size = kLongestText;
  while (size > kLongestText - 4 && continues(size)) --size;
  return size;
}

}  // namespace

Deputy::Deputy(Options options, DeputyOutbox outbox, Now now)
    : options_(std::move(options)),
      outbox_(std::move(outbox)),
      now_(now),
      discovery_end_(now.time + kDiscoveryTime),
      next_discovery_(now.time),
      next_report_(discovery_end_),
      last_measurement_(now.time),
      supervisor_({}, make_listener()) {
  host_meter_.measure();
}

void Deputy::handle(const Orders& orders, Now now) {
  now_ = now;
  const bool stale = orders.utime < now.utime - kOldestOrders;  // theirs is whatever the network says
  if (orders.host != options_.name || stale || discovering(now) || shutting_down_) return;
  note_sheriff(orders.sheriff_name, now);
  for (auto& [sheriff_id, entry] : entries_) {
    const auto listed = [id = sheriff_id](const OrderedCommand& order) { return order.sheriff_id == id; };
    if (std::none_of(orders.commands.begin(), orders.commands.end(), listed)) entry.listed = false;
  }
  for (const OrderedCommand& order : orders.commands) take_order(order);
  pursue_all();
}

void Deputy::handle(const Info& info, Now now) {
  if (!discovering(now) || info.host != options_.name) return;
  conflict_ = {2, "a deputy \"" + options_.name + "\" is at work already"};
}

void Deputy::handle(const Discovery& discovery, Now now) {
  if (!discovering(now)) {
    send_info(now);
  } else if (discovery.host == options_.name && discovery.nonce != options_.nonce) {
    conflict_ = {1, "another deputy \"" + options_.name + "\" is starting, too"};
  }
}

void Deputy::step(Now now, std::chrono::milliseconds timeout) {
  now_ = now;
  supervisor_.poll(timeout);
  if (discovering(now)) {
    if (now.time < next_discovery_) return;
    next_discovery_ = now.time + kDiscoveryPeriod;
    outbox_.discovery({now.utime, options_.name, options_.nonce});
    return;
  }
  pursue_all();
  if (now.time >= next_report_) {
    measure(now);
    changed_ = true;
  }
  if (changed_) send_info(now);
}

void Deputy::shut_down() {
  shutting_down_ = true;
  for (auto& [sheriff_id, entry] : entries_) supervisor_.stop(entry.id);
}

/// Sheriffs heed each other, but those of others may not.
void Deputy::note_sheriff(const std::string& name, Now now) {
  if (name != sheriff_) {
    // One that follows another is no trouble; one that comes back is.
    const bool both_at_work = name == sheriff_before_ && now.time - sheriff_before_heard_ < kSheriffMemory;
    if (both_at_work)
      say(kDeputyItself, "two sheriffs are at work, " + sheriff_ + " and " + name + ": end one of them\n");
    sheriff_before_ = std::exchange(sheriff_, name);
    sheriff_before_heard_ = sheriff_heard_;
  }
  sheriff_heard_ = now.time;
}

void Deputy::take_order(const OrderedCommand& order) {
  const auto [found, is_new] = entries_.try_emplace(order.sheriff_id);
  Entry& entry = found->second;
  if (is_new) {
    entry.id = supervisor_.add(to_command(order.definition, options_.name));
  } else if (entry.order.definition != order.definition) {
    supervisor_.redefine(entry.id, to_command(order.definition, options_.name));
  }
  changed_ |= is_new || entry.order != order;
  entry.order = order;
  entry.listed = true;
}

/// Moves a command towards what is ordered; its stop may take a while, after which it goes on here.
void Deputy::pursue(Entry& entry) {
  const OrderedCommand& order = entry.order;
  const CommandState state = supervisor_.state(entry.id);
  const bool idle = state == CommandState::stopped || state == CommandState::respawning;
  const bool other_run = entry.actual_runid != order.desired_runid;
  if (!entry.listed || order.force_quit || (other_run && !idle)) supervisor_.stop(entry.id);
  if (!idle) return;
  if (entry.listed && other_run && !order.force_quit) start(entry);
  if (other_run) changed_ = true;
  entry.actual_runid = order.desired_runid;
}

void Deputy::start(Entry& entry) {
  entry.refused = !is_allowed(entry.order.definition);
  if (!entry.refused) {
    supervisor_.start(entry.id);
  } else {
    say_line(entry, "is not among the commands that this deputy may run");
  }
}

void Deputy::pursue_all() {
  if (shutting_down_) return;
  for (auto& [sheriff_id, entry] : entries_) {
    pursue(entry);
    const pid_t pid = pid_to_report(entry);
    if (std::exchange(entry.reported_pid, pid) != pid) changed_ = true;
  }
  const auto forgotten = [&](const auto& item) {
    const Entry& entry = item.second;
    if (entry.listed || supervisor_.state(entry.id) != CommandState::stopped) return false;
    supervisor_.remove(entry.id);
    changed_ = true;
    return true;
  };
  std::erase_if(entries_, forgotten);
}

bool Deputy::is_allowed(const CommandDefinition& definition) const {
  if (!options_.allowed) return true;
  const auto& commands = options_.allowed->commands;
  return std::any_of(commands.begin(), commands.end(), [&](const Command& command) {
    return command.name == definition.name && command.exec == definition.exec;
  });
}

/// One that is being stopped runs until the last of its processes has ended.
pid_t Deputy::pid_to_report(const Entry& entry) const {
  const SupervisedCommand& command = supervisor_.at(entry.id);
  return command.state() == CommandState::stopping ? command.session() : command.pid();
}

ReportedCommand Deputy::report(const Entry& entry) const {
  const SupervisedCommand& command = supervisor_.at(entry.id);
  ReportedCommand reported;
  reported.definition = entry.order.definition;
  reported.sheriff_id = entry.order.sheriff_id;
  reported.actual_runid = entry.actual_runid;
  reported.pid = pid_to_report(entry);
  reported.exit_code = entry.refused ? kRefused : command.wait_status();
  if (reported.pid == 0) return reported;
  reported.cpu_usage = static_cast<float>(entry.cpu_usage);
  reported.virtual_bytes = entry.usage.virtual_bytes;
  reported.resident_bytes = entry.usage.resident_bytes;
  return reported;
}

void Deputy::send_info(Now now) {
  Info info;
  info.utime = now.utime;
  info.host = options_.name;
  info.cpu_load = static_cast<float>(host_usage_.cpu_load);
  info.memory_total_bytes = host_usage_.memory_total_bytes;
  info.memory_free_bytes = host_usage_.memory_free_bytes;
  info.swap_total_bytes = host_usage_.swap_total_bytes;
  info.swap_free_bytes = host_usage_.swap_free_bytes;
  for (const auto& [sheriff_id, entry] : entries_) info.commands.push_back(report(entry));
  outbox_.info(info);
  changed_ = false;
}

void Deputy::measure(Now now) {
  next_report_ = now.time + kReportPeriod;
  host_usage_ = host_meter_.measure();
  std::vector<pid_t> roots;
  for (const auto& [sheriff_id, entry] : entries_) roots.push_back(supervisor_.at(entry.id).pid());
  const std::vector<ProcessUsage> usages = measure_processes(roots);
  const double seconds = std::chrono::duration<double>(now.time - last_measurement_).count();
  last_measurement_ = now.time;
  std::size_t i = 0;
  for (auto& [sheriff_id, entry] : entries_) {
    const double used = usages[i].cpu_seconds - entry.usage.cpu_seconds;
    entry.cpu_usage = seconds > 0 ? std::clamp(used / seconds / processor_count(), 0.0, 1.0) : 0.0;
    entry.usage = usages[i++];
    const std::size_t left_out = entry.output_limit.renew();
    if (left_out > 0) say(sheriff_id, "\n[" + std::to_string(left_out) + " bytes of output were left out]\n");
  }
}

CommandListener Deputy::make_listener() {
  const auto announce = [this](CommandId id, const std::string& event) {
    changed_ = true;
    if (const Entry* entry = find(id)) say_line(*entry, event);
  };
  const auto pass_on = [this](CommandId id, std::string_view bytes) {
    if (Entry* entry = find(id)) send_output(*entry, bytes);
  };
  return {pass_on, announce, announce};
}

void Deputy::send_output(Entry& entry, std::string_view bytes) {
  bytes = entry.output_limit.admit(bytes);
  while (!bytes.empty()) {
    const std::size_t size = text_size(bytes);
    say(entry.order.sheriff_id, std::string(bytes.substr(0, size)));
    bytes.remove_prefix(size);
  }
}

void Deputy::say_line(const Entry& entry, const std::string& text) {
  std::string line = entry.order.definition.name;
  line += " " + text + "\n";
  say(kDeputyItself, line.substr(0, kLongestText));
}

void Deputy::say(std::int32_t sheriff_id, const std::string& text) {
  std::string whole = text;
  std::replace(whole.begin(), whole.end(), '\0', ' ');  // where a zero stands, the receiver's string would end
  outbox_.printf({now_.utime, options_.name, sheriff_id, whole});
}

Deputy::Entry* Deputy::find(CommandId id) {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [id](const auto& item) { return item.second.id == id; });
  return found == entries_.end() ? nullptr : &found->second;
}

}  // namespace eg::procman
