#pragma once

#include <sys/types.h>

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace eg::procman {

/// A line of the kernel's process table.
struct Process {
  pid_t pid = 0;
  pid_t parent = 0;
  pid_t session = 0;
  bool alive = false;  ///< no zombie
  std::int64_t cpu_ticks = 0;
  std::int64_t virtual_bytes = 0;
  std::int64_t resident_pages = 0;
};

std::vector<Process> list_processes();

/// `members` and all their descendants among `processes`.
std::set<pid_t> with_descendants(const std::vector<Process>& processes, std::set<pid_t> members);

/// All living descendants (no zombies) of a process, without itself.
std::vector<pid_t> find_descendants(pid_t root);

/// The living descendants of this process that belong to the command whose first process is or was `root`: itself, its
/// descendants, its session, and whoever carries `marker` ("NAME=VALUE") in the environment it was started with. The
/// marker finds what has left the tree and the session (daemons). This process must be a child subreaper, so that
/// orphans stay its descendants.
std::vector<pid_t> find_members(pid_t root, const std::string& marker);

}  // namespace eg::procman
