#pragma once

#include <cstddef>

namespace eg::messages {

/// The largest block that operator new has handed out since reset_largest_allocation(), bytes.
std::size_t largest_allocation();
void reset_largest_allocation();

}  // namespace eg::messages
