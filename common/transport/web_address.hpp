#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/result.hpp"

namespace eg::transport {

/// Where browsers find a service: a numeric host and a TCP port.
struct WebAddress {
  std::string host;  ///< without brackets
  std::uint16_t port = 0;
};

/// Where a page is served unless somebody says otherwise: this machine only.
inline constexpr char kDefaultWebAddress[] = "127.0.0.1:8080";

/// A host without ":8080" behind it; the colons of an IPv6 address in brackets stay.
std::string_view without_port(std::string_view host);

/// "127.0.0.1:8080" or "[::1]:8080".
base::Result<WebAddress> parse_web_address(std::string_view text);

/// Whether a server could listen at the address just now; the error says why it could not.
base::Status check_web_address(const std::string& text);

/// The default address, or where its port is taken the same on the first free one of the 100 after it.
base::Result<std::string> find_free_web_address();

}  // namespace eg::transport
