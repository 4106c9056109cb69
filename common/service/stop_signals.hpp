#pragma once

namespace eg::service {

/// Makes SIGINT, SIGTERM and SIGHUP ask for the end instead of killing. A second one of a kind kills, as it always did.
void catch_stop_signals();

/// True once such a signal has come.
bool stop_requested();

}  // namespace eg::service
