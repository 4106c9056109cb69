#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Reads the text tables of /proc/net.
namespace eg::doctor {

/// A counter of /proc/net/snmp, e.g. "Udp", "RcvbufErrors"; nothing if it is not there.
std::optional<std::int64_t> snmp_counter(std::string_view snmp, std::string_view protocol, std::string_view counter);

/// The inode numbers of the sockets that are bound to a port, of /proc/net/udp.
std::vector<std::uint64_t> sockets_on_port(std::string_view udp, int port);

/// The device that datagrams to an IPv4 address (network byte order) leave through, of /proc/net/route; nothing if
/// there is no route.
std::optional<std::string> device_towards(std::string_view route, std::uint32_t address);

/// The device of the default route; nothing if there is none.
std::optional<std::string> default_device(std::string_view route);

/// The process that has a socket open and its name, e.g. "lcm-logger (17)", as far as /proc lets us see it.
std::optional<std::string> owner_of_socket(std::uint64_t inode);

/// The whole of a file of /proc; empty if it cannot be read.
std::string read_table(const char* path);

}  // namespace eg::doctor
