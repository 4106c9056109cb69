#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "common/messages/control.hpp"

namespace eg::services {

/// How every service that has been heard of is doing.
class HealthView {
 public:
  /// A status came in. Returns true if the service is another process than the one heard before under its name.
  bool add(const messages::ServiceStatus& status, std::int64_t now_utime);

  /// The packet "health": for how long no frame has come (`silence`, microseconds), and one row per service, rates and
  /// CPU over the last seconds. A service that has said nothing for three seconds, and not that it ends, is silent.
  [[nodiscard]] std::vector<std::uint8_t> packet(std::int64_t now_utime, std::int64_t silence) const;

 private:
  struct Service {
    std::deque<messages::ServiceStatus> recent;  ///< the last few, of one process
    std::int64_t heard_utime = 0;                ///< monotonic
  };

  std::map<std::string, Service> services_;  ///< by name and host
};

}  // namespace eg::services
