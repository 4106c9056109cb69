#include "common/procman/supervisor.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>

#include "common/procman/process_tree.hpp"

namespace eg::procman {
namespace {

constexpr std::chrono::milliseconds kTick{20};  ///< the end of a process need not show in its output
constexpr char kMarkerName[] = "PROCMAN_COMMAND_ID";

std::string make_marker(std::size_t command) {
  return std::string(kMarkerName) + "=" + std::to_string(getpid()) + ":" + std::to_string(command);
}

}  // namespace

Supervisor::Supervisor(const std::vector<Command>& commands, CommandListener listener)
    : listener_(std::move(listener)) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  for (std::size_t i = 0; i < commands.size(); ++i) commands_.emplace_back(commands[i], make_marker(i), listener_);
}

Supervisor::~Supervisor() { kill_everything(); }

void Supervisor::start(std::size_t command) {
  note_start(command);
  commands_[command].start(Clock::now());
}

void Supervisor::stop(std::size_t command) { commands_[command].stop(Clock::now()); }

void Supervisor::restart(std::size_t command) {
  note_start(command);
  commands_[command].restart(Clock::now());
}

void Supervisor::poll(std::chrono::milliseconds timeout) {
  std::vector<pollfd> outputs;
  for (const SupervisedCommand& command : commands_) {
    if (command.output() >= 0) outputs.push_back({command.output(), POLLIN, 0});
  }
  ::poll(outputs.data(), outputs.size(), static_cast<int>(std::min(timeout, kTick).count()));
  for (SupervisedCommand& command : commands_) command.read_output();
  reap();
  for (SupervisedCommand& command : commands_) command.tick(Clock::now());
}

bool Supervisor::busy() const {
  return std::any_of(commands_.begin(), commands_.end(),
                     [](const SupervisedCommand& command) { return command.state() != CommandState::stopped; });
}

void Supervisor::stop_all(const std::function<bool()>& hurry) {
  for (auto command = start_order_.rbegin(); command != start_order_.rend() && !hurry(); ++command) {
    stop(*command);
    while (state(*command) != CommandState::stopped && !hurry()) poll(kTick);
  }
  kill_everything();
}

void Supervisor::reap() {
  int wait_status = 0;
  for (pid_t pid = 0; (pid = waitpid(-1, &wait_status, WNOHANG)) > 0;) {
    const auto ended = std::find_if(commands_.begin(), commands_.end(),
                                    [&](const SupervisedCommand& command) { return command.pid() == pid; });
    // Others are orphans of the commands, adopted by this process.
    if (ended != commands_.end()) ended->handle_exit(wait_status, Clock::now());
  }
}

void Supervisor::note_start(std::size_t command) {
  std::erase(start_order_, command);
  start_order_.push_back(command);
}

void Supervisor::kill_everything() {
  for (SupervisedCommand& command : commands_) command.stop(Clock::now());
  for (auto left = find_descendants(getpid()); !left.empty(); left = find_descendants(getpid())) {
    for (const pid_t pid : left) ::kill(pid, SIGKILL);
    poll(kTick);
  }
  reap();
}

}  // namespace eg::procman
