#include "common/procman/protocol.hpp"

#include <cmath>
#include <csignal>

#include "common/procman/wire.hpp"

namespace eg::procman {
namespace {

// A visitor goes through the fields of a type in their order on the wire. With a WireWriter it writes them, with a
// WireReader it fills them in. `check` is for what a reader must not take on trust.

void check(WireReader& wire, const CommandDefinition& definition) {
  wire.require(definition.stop_signal >= 0 && definition.stop_signal <= SIGRTMAX, "stop_signal", "is no signal");
  constexpr float kLongest = std::chrono::duration<float>(kLongestStopTime).count();
  const float time = definition.stop_time_allowed;
  wire.require(std::isfinite(time) && time >= 0 && time <= kLongest, "stop_time_allowed", "is out of range");
}
void check(WireReader& wire, const ReportedCommand& command) {
  wire.require(std::isfinite(command.cpu_usage), "cpu_usage", "is not finite");
}
void check(WireReader& wire, const Info& info) {
  wire.require(std::isfinite(info.cpu_load), "cpu_load", "is not finite");
}
template <typename Message>
void check(WireWriter& /*wire*/, const Message& /*message*/) {}

template <typename Wire, typename Definition>
void visit_definition(Wire& wire, Definition& definition) {
  wire.field("exec_str", definition.exec);
  wire.field("command_name", definition.name);
  wire.field("group", definition.group);
  wire.field("auto_respawn", definition.auto_respawn);
  wire.field("stop_signal", definition.stop_signal);
  wire.field("stop_time_allowed", definition.stop_time_allowed);
  wire.options(definition.options);
  check(wire, definition);
}

const auto visit_ordered = [](auto& wire, auto& command) {
  visit_definition(wire, command.definition);
  wire.field("desired_runid", command.desired_runid);
  wire.field("force_quit", command.force_quit);
  wire.field("sheriff_id", command.sheriff_id);
};

const auto visit_reported = [](auto& wire, auto& command) {
  visit_definition(wire, command.definition);
  wire.field("pid", command.pid);
  wire.field("actual_runid", command.actual_runid);
  wire.field("exit_code", command.exit_code);
  wire.field("cpu_usage", command.cpu_usage);
  wire.field("mem_vsize_bytes", command.virtual_bytes);
  wire.field("mem_rss_bytes", command.resident_bytes);
  wire.field("sheriff_id", command.sheriff_id);
  check(wire, command);
};

constexpr std::uint64_t kOrdersFingerprint = 0xef1277a9fdb17943;
const auto visit_orders = [](auto& wire, auto& orders) {
  wire.field("utime", orders.utime);
  wire.field("host", orders.host);
  wire.field("sheriff_name", orders.sheriff_name);
  wire.list("ncmds", orders.commands, visit_ordered);
  wire.options(orders.options);
};

constexpr std::uint64_t kInfoFingerprint = 0xd0cf2ed34edd8314;
const auto visit_info = [](auto& wire, auto& info) {
  wire.field("utime", info.utime);
  wire.field("host", info.host);
  wire.field("cpu_load", info.cpu_load);
  wire.field("phys_mem_total_bytes", info.memory_total_bytes);
  wire.field("phys_mem_free_bytes", info.memory_free_bytes);
  wire.field("swap_total_bytes", info.swap_total_bytes);
  wire.field("swap_free_bytes", info.swap_free_bytes);
  wire.list("ncmds", info.commands, visit_reported);
  wire.options(info.options);
  check(wire, info);
};

constexpr std::uint64_t kPrintfFingerprint = 0x0abac44d8e3a7bad;
const auto visit_printf = [](auto& wire, auto& text) {
  wire.field("utime", text.utime);
  wire.field("deputy_name", text.deputy_name);
  wire.field("sheriff_id", text.sheriff_id);
  wire.field("text", text.text);
};

constexpr std::uint64_t kDiscoveryFingerprint = 0x1116e1fff6333a71;
const auto visit_discovery = [](auto& wire, auto& discovery) {
  wire.field("utime", discovery.utime);
  wire.field("host", discovery.host);
  wire.field("nonce", discovery.nonce);
};

template <typename Visit, typename Message>
ProtocolBytes write(std::uint64_t fingerprint, Visit visit, const Message& message) {
  WireWriter writer(fingerprint);
  visit(writer, message);
  return writer.take();
}

template <typename Message, typename Visit>
base::Result<Message> read(std::uint64_t fingerprint, Visit visit, std::span<const std::uint8_t> bytes) {
  WireReader reader(bytes, fingerprint);
  Message message;
  visit(reader, message);
  if (const base::Status status = reader.status(); !status) return tl::make_unexpected(status.error());
  return message;
}

}  // namespace

ProtocolBytes encode(const Orders& orders) { return write(kOrdersFingerprint, visit_orders, orders); }
ProtocolBytes encode(const Info& info) { return write(kInfoFingerprint, visit_info, info); }
ProtocolBytes encode(const Printf& text) { return write(kPrintfFingerprint, visit_printf, text); }
ProtocolBytes encode(const Discovery& discovery) { return write(kDiscoveryFingerprint, visit_discovery, discovery); }

template <>
base::Result<Orders> decode(std::span<const std::uint8_t> bytes) {
  return read<Orders>(kOrdersFingerprint, visit_orders, bytes);
}

template <>
base::Result<Info> decode(std::span<const std::uint8_t> bytes) {
  return read<Info>(kInfoFingerprint, visit_info, bytes);
}

template <>
base::Result<Printf> decode(std::span<const std::uint8_t> bytes) {
  return read<Printf>(kPrintfFingerprint, visit_printf, bytes);
}

template <>
base::Result<Discovery> decode(std::span<const std::uint8_t> bytes) {
  return read<Discovery>(kDiscoveryFingerprint, visit_discovery, bytes);
}

CommandDefinition to_definition(const Command& command) {
  CommandDefinition definition;
  definition.exec = command.exec;
  definition.name = command.name;
  definition.group = command.group;
  definition.auto_respawn = command.auto_respawn;
  definition.stop_signal = static_cast<std::int8_t>(command.stop_signal);
  definition.stop_time_allowed = std::chrono::duration<float>(command.stop_time_allowed).count();
  return definition;
}

Command to_command(const CommandDefinition& definition, const std::string& host) {
  Command command;
  command.exec = definition.exec;
  command.name = definition.name;
  command.group = definition.group;
  command.host = host;
  command.auto_respawn = definition.auto_respawn;
  if (definition.stop_signal != 0) command.stop_signal = definition.stop_signal;
  if (definition.stop_time_allowed != 0) {
    command.stop_time_allowed =
        std::chrono::milliseconds(static_cast<std::int64_t>(1000.0 * definition.stop_time_allowed));
  }
  return command;
}

}  // namespace eg::procman
