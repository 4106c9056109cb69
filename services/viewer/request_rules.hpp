#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

/// Decisions on what browsers ask for, apart from the network.
namespace eg::services {

/// Whether a Host header names this machine by a loopback address or "localhost". Other names that lead here belong to
/// somebody else's website (DNS rebinding).
bool names_this_machine(std::string_view host_header);

/// Whether a page of this Origin header may talk to the server that was asked for as `host_header`. Programs other than
/// browsers send no origin.
bool is_same_origin(std::string_view origin, std::string_view host_header);

/// 12 of "/keyframe/12.jpg".
std::optional<std::int32_t> keyframe_of_path(std::string_view path);

/// The path of a request target, without the query: "/a?b" → "/a".
std::string_view path_of_target(std::string_view target);

}  // namespace eg::services
