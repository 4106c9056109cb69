#include "common/transport/lcm_url.hpp"

#include <arpa/inet.h>
#include <lcm/lcm.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <charconv>
#include <fstream>

namespace eg::transport {
namespace {

constexpr std::string_view kMulticastScheme = "udpm://";
constexpr int kAnyPort = 7667;  // the route to a group does not depend on the port
constexpr int kLargestTtl = 255;
constexpr int kLargestPort = 65535;

/// The whole of `text` as a number.
std::optional<std::int64_t> number(std::string_view text) {
  std::int64_t value = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc{} || parsed.ptr != end) return std::nullopt;
  return value;
}

base::Status read_option(std::string_view option, MulticastUrl& url) {
  const std::size_t equals = option.find('=');
  const std::string_view key = option.substr(0, equals);
  if (key != "ttl" && key != "recv_buf_size") return {};  // LCM has others
  const auto value = equals == std::string_view::npos ? std::nullopt : number(option.substr(equals + 1));
  if (!value || *value < 0 || (key == "ttl" && *value > kLargestTtl)) {
    return base::fail("the LCM URL's option '" + std::string(option) + "' has no usable value");
  }
  if (key == "ttl") url.ttl = static_cast<int>(*value);
  if (key == "recv_buf_size") url.receive_buffer = *value;
  return {};
}

/// Connecting a datagram socket sends nothing; it only looks the route up.
bool has_route(const in_addr& group) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  if (descriptor < 0) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(kAnyPort);
  address.sin_addr = group;
  const bool connected = connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(descriptor);
  return connected;
}

}  // namespace

base::Result<MulticastUrl> parse_multicast_url(std::string_view url) {
  if (!url.starts_with(kMulticastScheme))
    return base::fail("the LCM URL " + std::string(url) + " does not begin with udpm://");
  MulticastUrl result;
  std::string_view rest = url.substr(kMulticastScheme.size());
  std::string_view options = rest.find('?') == std::string_view::npos ? "" : rest.substr(rest.find('?') + 1);
  rest = rest.substr(0, rest.find('?'));
  if (const std::size_t colon = rest.find(':'); colon != std::string_view::npos) {
    const auto port = number(rest.substr(colon + 1));
    if (!port || *port < 1 || *port > kLargestPort)
      return base::fail("the LCM URL " + std::string(url) + " has no usable port");
    result.port = static_cast<int>(*port);
    rest = rest.substr(0, colon);
  }
  if (!rest.empty()) result.group = rest;
  while (!options.empty()) {
    const std::size_t end = options.find('&');
    if (const auto read = read_option(options.substr(0, end), result); !read) return tl::make_unexpected(read.error());
    options = end == std::string_view::npos ? "" : options.substr(end + 1);
  }
  return result;
}

std::string lcm_version() {
  std::string version = std::to_string(LCM_MAJOR_VERSION);
  version.append(".").append(std::to_string(LCM_MINOR_VERSION));
  version.append(".").append(std::to_string(LCM_MICRO_VERSION));
  return version;
}

std::string lcm_url_for_port(int port) {
  return "udpm://239.255.76.67:" + std::to_string(port) + "?ttl=0&recv_buf_size=2097152";
}

std::optional<int> udp_port(std::string_view url) {
  const auto parsed = parse_multicast_url(url);
  return parsed ? std::optional<int>(parsed->port) : std::nullopt;
}

int time_to_live(std::string_view url) {
  if (!url.starts_with(kMulticastScheme)) return 0;
  const auto parsed = parse_multicast_url(url);
  return parsed ? parsed->ttl : kLargestTtl;  // what cannot be read may go far
}

std::optional<std::int64_t> kernel_receive_buffer_limit() {
  std::ifstream file("/proc/sys/net/core/rmem_max");
  std::int64_t limit = 0;
  if (!(file >> limit)) return std::nullopt;
  return limit;
}

std::optional<std::string> receive_buffer_advice(std::string_view url, std::int64_t kernel_limit) {
  if (!url.starts_with(kMulticastScheme)) return std::nullopt;
  const auto parsed = parse_multicast_url(url);
  if (!parsed) return parsed.error().message;
  const auto wanted = parsed->receive_buffer;
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
  const auto parsed = parse_multicast_url(url);
  if (!parsed) return tl::make_unexpected(parsed.error());
  const std::string& group = parsed->group;
  in_addr address{};
  if (inet_pton(AF_INET, group.c_str(), &address) != 1) {
    return base::fail("'" + group + "' in the LCM URL " + std::string(url) + " is no IPv4 address");
  }
  if (!IN_MULTICAST(ntohl(address.s_addr))) {
    return base::fail("'" + group + "' in the LCM URL " + std::string(url) +
                      " is no multicast address (224.0.0.0 to 239.255.255.255)");
  }
  if (!has_route(address)) {
    return base::fail("there is no multicast route to " + group +
                      ": run `ip link set lo up; ip route add 224.0.0.0/4 dev lo` as root");
  }
  return {};
}

}  // namespace eg::transport
