#include "services/viewer/request_rules.hpp"

#include <charconv>

#include "common/transport/web_address.hpp"

namespace eg::services {
namespace {

std::optional<std::int32_t> parse_number(std::string_view digits) {
  std::int32_t number = 0;
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool whole = parsed.ec == std::errc{} && parsed.ptr == digits.data() + digits.size();
  return whole ? std::optional(number) : std::nullopt;
}

}  // namespace

bool names_this_machine(std::string_view host_header) {
  const std::string_view host = transport::without_port(host_header);
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
  return parse_number(path.substr(kFolder.size(), path.size() - kFolder.size() - kExtension.size()));
}

std::string_view path_of_target(std::string_view target) { return target.substr(0, target.find('?')); }

}  // namespace eg::services
