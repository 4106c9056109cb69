#pragma once

#include <string>

namespace eg::test {

/// Moves this thread, which must be the process's only one unless it is root's, into a network namespace of its own
/// with nothing but the loopback device and, if wanted, a multicast route over it, so that tests neither need the
/// machine's network nor disturb it.
/// @return why it could not be done (no permission), or nothing
std::string enter_private_network(bool with_multicast_route);

}  // namespace eg::test
