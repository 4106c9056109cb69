#include "services/doctor/machine_checks.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <string_view>

#include "common/transport/lcm_url.hpp"
#include "services/doctor/kernel_tables.hpp"

namespace eg::doctor {
namespace {

using transport::MulticastUrl;

bool goes_to_loopback(const std::string& group, std::string_view route) {
  in_addr address{};
  inet_pton(AF_INET, group.c_str(), &address);
  return device_towards(route, address.s_addr) == "lo";
}

Finding check_route(const std::string& lcm_url, const MulticastUrl& url) {
  if (const auto route = transport::check_multicast_route(lcm_url); !route) {
    return {Severity::error, "there is no multicast route to " + url.group,
            "ip link set lo up; ip route add 224.0.0.0/4 dev lo"};
  }
  const std::string routes = read_table("/proc/net/route");
  if (url.ttl == 0 || !goes_to_loopback(url.group, routes)) {
    return {Severity::good, "multicast route to " + url.group, ""};
  }
  const std::string device = default_device(routes).value_or("DEVICE");
  return {Severity::error, "ttl is above 0, but the multicast route leads to this machine itself",
          "ip route replace 224.0.0.0/4 dev " + device};
}

Finding check_ttl(const MulticastUrl& url) {
  if (url.ttl == 0) return {Severity::good, "ttl 0: messages stay on this machine", ""};
  if (url.ttl == 1) {
    return {Severity::good, "ttl 1: messages reach all machines of this network segment; LCM has no authentication",
            ""};
  }
  return {Severity::warning, fmt::format("ttl {}: messages may leave the network segment unprotected", url.ttl),
          "use ttl=1 in --lcm-url"};
}

Finding check_receive_buffer(const std::string& lcm_url, const MulticastUrl& url) {
  const std::int64_t limit = transport::kernel_receive_buffer_limit().value_or(0);
  if (!transport::receive_buffer_advice(lcm_url, limit)) {
    return {Severity::good, fmt::format("receive buffer of {} bytes", *url.receive_buffer), ""};
  }
  if (!url.receive_buffer) {
    return {Severity::warning, "the LCM URL sets no receive buffer, so large messages will be lost",
            "add recv_buf_size=2097152 to --lcm-url"};
  }
  return {Severity::warning,
          fmt::format("the kernel limits receive buffers to {} of {} bytes wanted, so large messages may be lost",
                      limit, *url.receive_buffer),
          fmt::format("sysctl -w net.core.rmem_max={}", *url.receive_buffer)};
}

/// LCM's sockets share a port; one of another kind keeps it for itself.
bool can_share(int port) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  const int yes = 1;
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEPORT, &yes, sizeof(yes));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const bool bound = bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(descriptor);
  return bound;
}

Finding check_port(const MulticastUrl& url) {
  std::string owners;
  const auto sockets = sockets_on_port(read_table("/proc/net/udp"), url.port);
  for (const std::uint64_t socket : sockets) {
    const auto owner = owner_of_socket(socket);
    if (!owner) continue;
    if (!owners.empty()) owners += ", ";
    owners += *owner;
  }
  if (!can_share(url.port)) {
    return {Severity::error, fmt::format("port {} is taken by {}, which does not share it", url.port, owners),
            fmt::format("choose another port in --lcm-url, e.g. {}", transport::lcm_url_for_port(url.port + 1))};
  }
  std::string what = fmt::format("port {}: {} listeners on this machine", url.port, sockets.size());
  if (!owners.empty()) what += ": " + owners;
  return {Severity::good, what, ""};
}

Finding versions() {
  utsname kernel{};
  uname(&kernel);
  return {Severity::good,
          fmt::format("egraph {}, LCM {}, {} {}, host {}", EGRAPH_VERSION, transport::lcm_version(), kernel.sysname,
                      kernel.release, kernel.nodename),
          ""};
}

}  // namespace

Findings check_machine(const std::string& lcm_url) {
  Findings findings = {versions()};
  const auto url = transport::parse_multicast_url(lcm_url);
  if (!url) {
    findings.push_back({Severity::error, url.error().message, std::string("use ") + transport::kDefaultLcmUrl});
    return findings;
  }
  findings.push_back(check_route(lcm_url, *url));
  findings.push_back(check_ttl(*url));
  findings.push_back(check_receive_buffer(lcm_url, *url));
  findings.push_back(check_port(*url));
  return findings;
}

KernelDrops kernel_drops() {
  const std::string snmp = read_table("/proc/net/snmp");
  return {snmp_counter(snmp, "Udp", "RcvbufErrors").value_or(0), snmp_counter(snmp, "Ip", "ReasmFails").value_or(0)};
}

Findings check_drops(const KernelDrops& before, const KernelDrops& after) {
  Findings findings;
  if (const std::int64_t count = after.full_buffers - before.full_buffers; count > 0) {
    findings.push_back({Severity::warning,
                        fmt::format("the kernel threw {} datagrams away because a receive buffer was full", count),
                        "sysctl -w net.core.rmem_max=8388608, and recv_buf_size=8388608 in --lcm-url"});
  }
  if (const std::int64_t count = after.incomplete_datagrams - before.incomplete_datagrams; count > 0) {
    findings.push_back({Severity::warning,
                        fmt::format("{} datagrams could not be put together, because fragments were lost", count),
                        "sysctl -w net.ipv4.ipfrag_high_thresh=16777216; if it stays so, the network loses packets"});
  }
  return findings;
}

}  // namespace eg::doctor
