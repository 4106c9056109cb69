#include "common/transport/web_address.hpp"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <memory>
#include <optional>
#include <system_error>

namespace eg::transport {
namespace {

constexpr int kPortsToTry = 100;

std::string in_quotes(std::string_view text) { return std::string("'").append(text).append("'"); }

std::optional<std::uint16_t> parse_port(std::string_view digits) {
  std::uint16_t port = 0;
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  const bool whole = parsed.ec == std::errc{} && parsed.ptr == digits.data() + digits.size();
  return whole ? std::optional(port) : std::nullopt;
}

/// What binding a socket to the address comes to: 0, or the error's number.
int try_to_bind(const addrinfo& address) {
  const int socket = ::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return errno;
  const int yes = 1;  // connections of a server that has ended do not count
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const int failure = bind(socket, address.ai_addr, address.ai_addrlen) == 0 ? 0 : errno;
  close(socket);
  return failure;
}

}  // namespace

std::string_view without_port(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  if (colon == std::string_view::npos || host.ends_with(']')) return host;
  return host.substr(0, colon);
}

base::Result<WebAddress> parse_web_address(std::string_view text) {
  std::string_view host = without_port(text);
  const auto port = host.size() + 1 < text.size() ? parse_port(text.substr(host.size() + 1)) : std::nullopt;
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  if (host.empty() || !port) {
    return base::fail(in_quotes(text) + " is not an address like 127.0.0.1:8080 or [::1]:8080");
  }
  return WebAddress{std::string(host), *port};
}

base::Status check_web_address(const std::string& text) {
  const auto address = parse_web_address(text);
  if (!address) return tl::make_unexpected(address.error());
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int unknown = getaddrinfo(address->host.c_str(), std::to_string(address->port).c_str(), &hints, &found);
  if (unknown != 0) return base::fail(in_quotes(address->host) + " is no numeric address: " + gai_strerror(unknown));
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, &freeaddrinfo);
  const int failure = try_to_bind(*found);
  if (failure == 0) return {};
  return base::fail("browsers cannot be served at " + text + ": " + std::generic_category().message(failure));
}

base::Result<std::string> find_free_web_address() {
  const auto first = parse_web_address(kDefaultWebAddress);
  base::Status status;
  for (int i = 0; i < kPortsToTry; ++i) {
    const std::string address = first->host + ":" + std::to_string(first->port + i);
    if (status = check_web_address(address); status) return address;
  }
  return tl::make_unexpected(status.error());
}

}  // namespace eg::transport
