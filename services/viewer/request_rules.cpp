#include "services/viewer/request_rules.hpp"

#include <spdlog/fmt/fmt.h>

#include <charconv>

namespace eg::services {
namespace {

template <typename Number>
std::optional<Number> parse_number(std::string_view digits) {
  Number number{};
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool whole = parsed.ec == std::errc{} && parsed.ptr == digits.data() + digits.size();
  return whole ? std::optional<Number>(number) : std::nullopt;
}

/// Without ":8080" at the end; the colons of an IPv6 address in brackets stay.
std::string_view without_port(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  if (colon == std::string_view::npos || host.ends_with(']')) return host;
  return host.substr(0, colon);
}

}  // namespace

base::Result<HostAndPort> parse_host_and_port(std::string_view text) {
  std::string_view host = without_port(text);
  const bool has_port = host.size() + 1 < text.size();
  const auto port = has_port ? parse_number<std::uint16_t>(text.substr(host.size() + 1)) : std::nullopt;
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  if (host.empty() || !port) {
    return base::fail(fmt::format("'{}' is not an address like 127.0.0.1:8080 or [::1]:8080", text));
  }
  return HostAndPort{std::string(host), *port};
}

bool names_this_machine(std::string_view host_header) {
  const std::string_view host = without_port(host_header);
  return host == "localhost" || host == "[::1]" ||
         (host.starts_with("127.") && host.find_first_not_of("0123456789.") == std::string_view::npos);
}

bool is_same_origin(std::string_view origin, std::string_view host_header) {
  if (origin.empty()) return true;
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && origin.substr(kScheme.size()) == host_header;
}

std::optional<std::int32_t> keyframe_of_path(std::string_view path) {
  constexpr std::string_view kFolder = "/keyframe/";
  constexpr std::string_view kExtension = ".jpg";
  if (!path.starts_with(kFolder) || !path.ends_with(kExtension)) return std::nullopt;
  if (path.size() <= kFolder.size() + kExtension.size()) return std::nullopt;
  return parse_number<std::int32_t>(path.substr(kFolder.size(), path.size() - kFolder.size() - kExtension.size()));
}

std::string_view path_of_target(std::string_view target) { return target.substr(0, target.find('?')); }

}  // namespace eg::services
