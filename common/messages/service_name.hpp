#pragma once

#include <string_view>

namespace eg::messages {

/// Whether who reports as `name` is `service`, or one of several that share its work: mapper.0, mapper.1 and so on are
/// of the service mapper.
[[nodiscard]] inline bool is_of_service(std::string_view name, std::string_view service) {
  if (!name.starts_with(service)) return false;
  return name.size() == service.size() || name[service.size()] == '.';
}

}  // namespace eg::messages
