#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.hpp"

namespace eg::transport {

/// Where all processes meet unless they are told otherwise: this machine only (ttl=0), with a receive buffer that takes
/// whole images. LCM's own default buffer drops most messages above 200 kB.
inline constexpr char kDefaultLcmUrl[] = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152";

/// The default URL on another port. Processes on different ports do not hear each other.
std::string lcm_url_for_port(int port);

/// The parts of udpm://GROUP:PORT?ttl=N&recv_buf_size=BYTES; what is left out is LCM's default.
struct MulticastUrl {
  std::string group = "239.255.76.67";
  int port = 7667;
  int ttl = 0;                                   ///< 0: this machine only; 1: this network segment
  std::optional<std::int64_t> receive_buffer{};  ///< bytes
};

/// The error says which part cannot be read. URLs of other providers than udpm have no such parts and are an error.
base::Result<MulticastUrl> parse_multicast_url(std::string_view url);

/// Of the LCM library, e.g. "1.3.1".
std::string lcm_version();

/// The UDP port of a udpm:// URL, LCM's own if it names none; nothing for other URLs.
std::optional<int> udp_port(std::string_view url);

/// How many routers a message may pass: the ttl of a udpm:// URL, where 0 is this machine only.
int time_to_live(std::string_view url);

/// The largest receive buffer that this kernel grants (net.core.rmem_max), bytes; nothing if it cannot be read.
std::optional<std::int64_t> kernel_receive_buffer_limit();

/// What to do about a URL whose receive buffer is missing or above the kernel's limit, one sentence with the command;
/// nothing if all is well.
std::optional<std::string> receive_buffer_advice(std::string_view url, std::int64_t kernel_limit);

/// Whether this machine can send to the multicast group of a udpm:// URL (other URLs need none); the error names the
/// commands that mend it.
base::Status check_multicast_route(std::string_view url);

}  // namespace eg::transport
