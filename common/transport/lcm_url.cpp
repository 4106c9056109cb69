#include "common/transport/lcm_url.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>

namespace eg::transport {
namespace {

constexpr std::string_view kMulticastScheme = "udpm://";
constexpr int kDefaultPort = 7667;

/// The host part of udpm://HOST:PORT?OPTIONS; LCM's own group if it is left out.
std::string multicast_group(std::string_view url) {
  url.remove_prefix(kMulticastScheme.size());
  const std::string_view host = url.substr(0, url.find_first_of(":?"));
  return host.empty() ? "239.255.76.67" : std::string(host);
}

/// The number that `text` begins with.
std::optional<std::int64_t> leading_number(std::string_view text) {
  std::int64_t number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (parsed.ec != std::errc{}) return std::nullopt;
  return number;
}

/// The value of an option behind the question mark; `key` includes the equals sign.
std::optional<std::int64_t> number_of(std::string_view url, std::string_view key) {
  const std::size_t at = url.find(key);
  if (at == std::string_view::npos) return std::nullopt;
  return leading_number(url.substr(at + key.size()));
}

/// Connecting a datagram socket sends nothing; it only looks the route up.
bool has_route(const in_addr& group) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  if (descriptor < 0) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(kDefaultPort);
  address.sin_addr = group;
  const bool connected = connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(descriptor);
  return connected;
}

}  // namespace

std::string lcm_url_for_port(int port) {
  return "udpm://239.255.76.67:" + std::to_string(port) + "?ttl=0&recv_buf_size=2097152";
}

std::optional<int> udp_port(std::string_view url) {
  if (!url.starts_with(kMulticastScheme)) return std::nullopt;
  url.remove_prefix(kMulticastScheme.size());
  url = url.substr(0, url.find('?'));
  const std::size_t colon = url.find(':');
  if (colon == std::string_view::npos) return kDefaultPort;
  const auto port = leading_number(url.substr(colon + 1));
  return port && *port > 0 && *port < 65536 ? std::optional<int>(static_cast<int>(*port)) : std::nullopt;
}

int time_to_live(std::string_view url) {
  if (!url.starts_with(kMulticastScheme)) return 0;
  return static_cast<int>(std::clamp<std::int64_t>(number_of(url, "ttl=").value_or(0), 0, 255));
}

std::optional<std::int64_t> kernel_receive_buffer_limit() {
  std::ifstream file("/proc/sys/net/core/rmem_max");
  std::int64_t limit = 0;
  if (!(file >> limit)) return std::nullopt;
  return limit;
}

std::optional<std::string> receive_buffer_advice(std::string_view url, std::int64_t kernel_limit) {
  if (!url.starts_with(kMulticastScheme)) return std::nullopt;
  const auto wanted = number_of(url, "recv_buf_size=");
  if (!wanted) {
    return "the LCM URL sets no receive buffer, so large messages will be lost: add recv_buf_size=2097152 to it";
  }
  if (*wanted <= kernel_limit) return std::nullopt;
  return "the kernel limits receive buffers to " + std::to_string(kernel_limit) + " of the " + std::to_string(*wanted) +
         " bytes wanted, so large messages may be lost: run `sysctl -w net.core.rmem_max=" + std::to_string(*wanted) +
         "` as root";
}

base::Status check_multicast_route(std::string_view url) {
  if (!url.starts_with(kMulticastScheme)) return {};
  const std::string group = multicast_group(url);
  in_addr address{};
  if (inet_pton(AF_INET, group.c_str(), &address) != 1) {
    return base::fail("'" + group + "' in the LCM URL " + std::string(url) + " is no IPv4 address");
  }
  if (!has_route(address)) {
    return base::fail("there is no multicast route to " + group +
                      ": run `ip link set lo up; ip route add 224.0.0.0/4 dev lo` as root");
  }
  return {};
}

}  // namespace eg::transport
