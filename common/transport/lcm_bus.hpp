#pragma once

#include <memory>
#include <string>

#include "common/transport/bus.hpp"
#include "common/transport/lcm_url.hpp"

namespace eg::transport {

/// The bus between processes: LCM (Huang, Olson, Moore, IROS 2010), datagrams over UDP multicast. A message may be
/// lost; one that arrives is whole. A sender hears its own messages. Of a queue of capacity 1, LCM makes one of 2.
class LcmBus : public Bus {
 public:
  struct Options {
    std::string url = kDefaultLcmUrl;
    std::string channel_prefix;      ///< the bus hears and says only channels that begin with it
    bool only_this_machine = false;  ///< hear nothing that other machines send
  };

  /// Opens the network, or says what is wrong with the URL or the machine's network, and the commands that mend it.
  static base::Result<std::unique_ptr<LcmBus>> create(const Options& options);
};

}  // namespace eg::transport
