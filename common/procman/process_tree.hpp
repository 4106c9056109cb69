#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace eg::procman {

/// All living descendants (no zombies) of a process, without itself.
std::vector<pid_t> find_descendants(pid_t root);

/// The living descendants of this process that belong to the command whose first process is or was `root`: itself, its
/// descendants, its session, and whoever carries `marker` ("NAME=VALUE") in the environment it was started with. The
/// marker finds what has left the tree and the session (daemons). This process must be a child subreaper, so that
/// orphans stay its descendants.
std::vector<pid_t> find_members(pid_t root, const std::string& marker);

}  // namespace eg::procman
