#pragma once

#include "common/base/result.hpp"

namespace eg::transport {

/// Makes the sockets of this process that are bound to the UDP port `port` drop what other machines send: all datagrams
/// whose source is not an address that this machine has now. A forged source does not help: the kernel drops datagrams
/// that come from outside with an address of its own (unless accept_local is set).
///
/// An LCM URL with ttl=0 keeps what is said here from others, not what others say from here.
base::Status drop_datagrams_of_other_machines(int port);

}  // namespace eg::transport
