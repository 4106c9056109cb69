#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "common/procman/supervised_command.hpp"

namespace eg::procman {

/// Runs commands as children of this process, which becomes the child subreaper of all they start. One per process,
/// used by one thread; there must be no other children.
class Supervisor {
 public:
  Supervisor(const std::vector<Command>& commands, CommandListener listener);
  /// Kills what is still running.
  ~Supervisor();
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  void start(std::size_t command);
  void stop(std::size_t command);
  void restart(std::size_t command);

  /// Waits at most `timeout` for output or the end of a process, and does what is due.
  void poll(std::chrono::milliseconds timeout);

  /// True if any command is running or about to.
  [[nodiscard]] bool busy() const;
  [[nodiscard]] CommandState state(std::size_t command) const { return commands_[command].state(); }
  [[nodiscard]] Outcome outcome(std::size_t command) const { return commands_[command].outcome(); }
  [[nodiscard]] const Command& command(std::size_t index) const { return commands_[index].command(); }
  [[nodiscard]] std::size_t size() const { return commands_.size(); }

  /// Stops all commands, the last started first, each when the one before it has stopped. `hurry` is asked meanwhile:
  /// once it is true, all is killed at once.
  void stop_all(const std::function<bool()>& hurry);

 private:
  void reap();
  void note_start(std::size_t command);
  void kill_everything();

  CommandListener listener_;
  std::deque<SupervisedCommand> commands_;
  std::vector<std::size_t> start_order_;
};

}  // namespace eg::procman
