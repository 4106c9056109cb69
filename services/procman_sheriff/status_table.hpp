#pragma once

#include <string>
#include <vector>

#include "common/procman/now.hpp"
#include "common/procman/sheriff.hpp"

namespace eg::procman_sheriff {

/// A line for each command of the configuration, for each command that a deputy is about to forget, and for each
/// deputy, under a heading. Widths follow the content.
std::vector<std::string> make_status_table(const procman::Configuration& configuration, const procman::Sheriff& sheriff,
                                           procman::Now now);

}  // namespace eg::procman_sheriff
