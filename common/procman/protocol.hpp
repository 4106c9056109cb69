#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.hpp"
#include "common/procman/configuration.hpp"

/// The messages between sheriffs and deputies: libbot2's bot_procman, version 2 (lcmtypes/bot_procman_*.lcm).
namespace eg::procman {

namespace channels {
inline constexpr char kOrders[] = "PMD_ORDERS2";
inline constexpr char kInfo[] = "PMD_INFO2";
inline constexpr char kPrintf[] = "PMD_PRINTF";
inline constexpr char kDiscover[] = "PMD_DISCOVER";
}  // namespace channels

/// Extensions of the protocol, which nobody uses so far: names and their values.
using ProtocolOptions = std::vector<std::pair<std::string, std::string>>;

/// command2_t
struct CommandDefinition {
  std::string exec;
  std::string name;
  std::string group;
  bool auto_respawn = false;
  std::int8_t stop_signal = 0;  ///< 0: the default
  float stop_time_allowed = 0;  ///< seconds; 0: the default
  ProtocolOptions options;

  bool operator==(const CommandDefinition&) const = default;
};

/// sheriff_cmd2_t
struct OrderedCommand {
  CommandDefinition definition;
  std::int32_t desired_runid = 0;
  bool force_quit = false;
  std::int32_t sheriff_id = 0;

  bool operator==(const OrderedCommand&) const = default;
};

/// orders2_t
struct Orders {
  std::int64_t utime = 0;
  std::string host;
  std::string sheriff_name;
  std::vector<OrderedCommand> commands;
  ProtocolOptions options;

  bool operator==(const Orders&) const = default;
};

/// deputy_cmd2_t
struct ReportedCommand {
  CommandDefinition definition;
  std::int32_t pid = 0;
  std::int32_t actual_runid = 0;
  std::int32_t exit_code = 0;  ///< raw wait status
  float cpu_usage = 0;         ///< of all processors, in [0, 1]
  std::int64_t virtual_bytes = 0;
  std::int64_t resident_bytes = 0;
  std::int32_t sheriff_id = 0;

  bool operator==(const ReportedCommand&) const = default;
};

/// info2_t
struct Info {
  std::int64_t utime = 0;
  std::string host;
  float cpu_load = 0;  ///< of all processors, in [0, 1]
  std::int64_t memory_total_bytes = 0;
  std::int64_t memory_free_bytes = 0;
  std::int64_t swap_total_bytes = 0;
  std::int64_t swap_free_bytes = 0;
  std::vector<ReportedCommand> commands;
  ProtocolOptions options;

  bool operator==(const Info&) const = default;
};

/// printf_t
struct Printf {
  std::int64_t utime = 0;
  std::string deputy_name;
  std::int32_t sheriff_id = 0;
  std::string text;

  bool operator==(const Printf&) const = default;
};

/// discovery_t
struct Discovery {
  std::int64_t utime = 0;
  std::string host;
  std::int64_t nonce = 0;

  bool operator==(const Discovery&) const = default;
};

using ProtocolBytes = std::vector<std::uint8_t>;

ProtocolBytes encode(const Orders& orders);
ProtocolBytes encode(const Info& info);
ProtocolBytes encode(const Printf& text);
ProtocolBytes encode(const Discovery& discovery);

/// T is Orders, Info, Printf or Discovery. Accepts whole messages of the right type only; the error names the field. No
/// more memory is taken than a small multiple of the message's size.
template <typename T>
base::Result<T> decode(std::span<const std::uint8_t> bytes);

template <>
base::Result<Orders> decode(std::span<const std::uint8_t> bytes);
template <>
base::Result<Info> decode(std::span<const std::uint8_t> bytes);
template <>
base::Result<Printf> decode(std::span<const std::uint8_t> bytes);
template <>
base::Result<Discovery> decode(std::span<const std::uint8_t> bytes);

/// Between the protocol and the configuration. `place` and `host` of a command do not travel.
CommandDefinition to_definition(const Command& command);
Command to_command(const CommandDefinition& definition, const std::string& host);

}  // namespace eg::procman
