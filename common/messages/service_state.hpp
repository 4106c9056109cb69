#pragma once

namespace eg::messages {

/// ServiceStatus::state in the last status of a service that ends as it should.
inline constexpr char kEndedState[] = "ended";

}  // namespace eg::messages
