#include "common/procman/process_tree.hpp"

#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "common/base/read_stream.hpp"

namespace eg::procman {
namespace {

std::string read_proc(pid_t pid, const char* file) {
  std::ifstream stream("/proc/" + std::to_string(pid) + "/" + file, std::ios::binary);
  return base::read_stream(stream);
}

/// From the fields of /proc/PID/stat, numbered in proc(5). The second one, the program's name in parentheses, may hold
/// anything.
std::optional<Process> read_process(pid_t pid) {
  const std::string stat = read_proc(pid, "stat");
  const std::size_t end_of_name = stat.rfind(')');
  if (end_of_name == std::string::npos) return std::nullopt;
  std::istringstream fields(stat.substr(end_of_name + 1));
  Process process;
  process.pid = pid;
  char state = '?';
  std::string skipped;
  fields >> state >> process.parent >> skipped >> process.session;
  for (int field = 7; field <= 13; ++field) fields >> skipped;
  std::int64_t user_ticks = 0;
  std::int64_t system_ticks = 0;
  fields >> user_ticks >> system_ticks;
  for (int field = 16; field <= 22; ++field) fields >> skipped;
  if (!(fields >> process.virtual_bytes >> process.resident_pages)) return std::nullopt;
  process.cpu_ticks = user_ticks + system_ticks;
  process.alive = state != 'Z' && state != 'X';
  return process;
}

bool carries(pid_t pid, const std::string& marker) {
  const std::string environment = '\0' + read_proc(pid, "environ");
  return environment.find('\0' + marker + '\0') != std::string::npos;
}

std::vector<pid_t> living(const std::vector<Process>& processes, const std::set<pid_t>& members) {
  std::vector<pid_t> pids;
  for (const Process& process : processes) {
    if (process.alive && members.contains(process.pid)) pids.push_back(process.pid);
  }
  return pids;
}

}  // namespace

std::vector<Process> list_processes() {
  std::vector<Process> processes;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename().string();
    pid_t pid = 0;
    const auto parsed = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (parsed.ec != std::errc{} || parsed.ptr != name.data() + name.size()) continue;
    if (const auto process = read_process(pid)) processes.push_back(*process);
  }
  return processes;
}

std::set<pid_t> with_descendants(const std::vector<Process>& processes, std::set<pid_t> members) {
  // Children can have smaller numbers than parents, hence until nothing changes.
  bool grown = true;
  while (grown) {
    grown = false;
    for (const Process& process : processes) {
      if (members.contains(process.parent)) grown |= members.insert(process.pid).second;
    }
  }
  return members;
}

std::vector<pid_t> find_descendants(pid_t root) {
  const std::vector<Process> processes = list_processes();
  std::set<pid_t> members = with_descendants(processes, {root});
  members.erase(root);
  return living(processes, members);
}

namespace {

std::vector<pid_t> members_now(pid_t root, const std::string& marker) {
  std::vector<Process> processes = list_processes();
  const std::set<pid_t> ours = with_descendants(processes, {getpid()});
  std::erase_if(processes,
                [&](const Process& process) { return process.pid == getpid() || !ours.contains(process.pid); });
  std::set<pid_t> members;
  for (const Process& process : processes) {
    if (process.pid == root || process.session == root || carries(process.pid, marker)) members.insert(process.pid);
  }
  return living(processes, with_descendants(processes, members));
}

}  // namespace

std::vector<pid_t> find_members(pid_t root, const std::string& marker) {
  const std::vector<pid_t> members = members_now(root, marker);
  // A child that is born while the list is read, of a parent that ends meanwhile, is in the next list only.
  return members.empty() ? members_now(root, marker) : members;
}

}  // namespace eg::procman
