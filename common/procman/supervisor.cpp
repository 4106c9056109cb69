#include "common/procman/supervisor.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>

#include "common/base/check.hpp"
#include "common/procman/process_tree.hpp"

namespace eg::procman {
namespace {

constexpr std::chrono::milliseconds kTick{20};  ///< the end of a process need not show in its output

}  // namespace

Supervisor::Supervisor(const std::vector<Command>& commands, CommandListener listener)
    : listener_(std::move(listener)) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  for (const Command& command : commands) add(command);
}

Supervisor::~Supervisor() { kill_everything(); }

CommandId Supervisor::add(Command command) {
  const CommandId id = next_id_++;
  commands_.try_emplace(id, id, std::move(command), listener_);
  return id;
}

void Supervisor::remove(CommandId command) {
  EG_CHECK(state(command) == CommandState::stopped, "a command is stopped before it is removed");
  std::erase(start_order_, command);
  commands_.erase(command);
}

void Supervisor::start(CommandId command) {
  note_start(command);
  commands_.at(command).start(Clock::now());
}

void Supervisor::stop(CommandId command) { commands_.at(command).stop(Clock::now()); }

void Supervisor::restart(CommandId command) {
  note_start(command);
  commands_.at(command).restart(Clock::now());
}

Condition Supervisor::condition(CommandId command) const {
  const SupervisedCommand& supervised = at(command);
  if (supervised.state() == CommandState::running) return Condition::running;
  if (supervised.state() != CommandState::stopped) return Condition::changing;
  switch (supervised.outcome()) {
    case Outcome::none:
      return Condition::not_started;
    case Outcome::ok:
      return Condition::ended_well;
    case Outcome::error:
      return Condition::failed;
  }
  return Condition::failed;
}

void Supervisor::poll(std::chrono::milliseconds timeout) {
  std::vector<pollfd> outputs;
  for (const auto& [id, command] : commands_) {
    if (command.output() >= 0) outputs.push_back({command.output(), POLLIN, 0});
  }
  ::poll(outputs.data(), outputs.size(), static_cast<int>(std::min(timeout, kTick).count()));
  for (auto& [id, command] : commands_) command.read_output();
  reap();
  for (auto& [id, command] : commands_) command.tick(Clock::now());
}

bool Supervisor::busy() const {
  return std::any_of(commands_.begin(), commands_.end(),
                     [](const auto& entry) { return entry.second.state() != CommandState::stopped; });
}

void Supervisor::stop_all(const std::function<bool()>& hurry) {
  for (auto command = start_order_.rbegin(); command != start_order_.rend() && !hurry(); ++command) {
    stop(*command);
    while (state(*command) != CommandState::stopped && !hurry()) poll(kTick);
  }
  kill_everything();
}

void Supervisor::kill_everything() {
  for (auto& [id, command] : commands_) command.stop(Clock::now());
  for (auto left = find_descendants(getpid()); !left.empty(); left = find_descendants(getpid())) {
    for (const pid_t pid : left) ::kill(pid, SIGKILL);
    poll(kTick);
  }
  reap();
}

void Supervisor::reap() {
  int wait_status = 0;
  for (pid_t pid = 0; (pid = waitpid(-1, &wait_status, WNOHANG)) > 0;) {
    const auto ended =
        std::find_if(commands_.begin(), commands_.end(), [&](const auto& entry) { return entry.second.pid() == pid; });
    // Others are orphans of the commands, adopted by this process.
    if (ended != commands_.end()) ended->second.handle_exit(wait_status, Clock::now());
  }
}

void Supervisor::note_start(CommandId command) {
  std::erase(start_order_, command);
  start_order_.push_back(command);
}

}  // namespace eg::procman
