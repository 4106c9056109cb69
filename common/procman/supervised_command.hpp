#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "common/procman/configuration.hpp"
#include "common/procman/now.hpp"
#include "common/procman/spawn.hpp"

namespace eg::procman {

/// Number of a command within its supervisor.
using CommandId = std::size_t;

enum class CommandState {
  stopped,     ///< not running, and nothing is about to change that
  running,     ///< its first process runs
  stopping,    ///< asked to stop; until its last process is gone
  respawning,  ///< ended by itself, and will be started again after a pause
};

enum class Outcome { none, ok, error };  ///< of the last run: never run or still running, as it should, with an error

/// What a command reports.
struct CommandListener {
  std::function<void(CommandId, std::string_view bytes)> on_output;       ///< as they come, in pieces
  std::function<void(CommandId, const std::string& event)> on_event;      ///< "started", "ended", ...
  std::function<void(CommandId, const std::string& problem)> on_problem;  ///< it ended with an error unexpectedly
};

/// The life of one command: started, stopped with a signal and then with SIGKILL, started again when it dies if its
/// auto_respawn says so. Nothing of it outlives a stop. Driven by its supervisor.
class SupervisedCommand {
 public:
  SupervisedCommand(CommandId id, Command command, const CommandListener& listener);

  void start(Clock::time_point now);
  void stop(Clock::time_point now);
  void restart(Clock::time_point now);

  /// What runs goes on; the next start, and the next stop, are those of the new definition.
  void redefine(Command command) { command_ = std::move(command); }

  /// Deadlines and pauses.
  void tick(Clock::time_point now);
  /// The supervisor has reaped its first process.
  void handle_exit(int wait_status, Clock::time_point now);
  /// Passes on what the command has printed.
  void read_output();

  [[nodiscard]] const Command& command() const { return command_; }
  [[nodiscard]] CommandState state() const { return state_; }
  [[nodiscard]] Outcome outcome() const { return outcome_; }
  /// As waitpid() gave it for the last run, exit status 127 for what could not be started; 0: running,
  /// or never run.
  [[nodiscard]] int wait_status() const { return wait_status_; }
  [[nodiscard]] pid_t pid() const { return process_.pid; }            ///< 0: not running
  [[nodiscard]] pid_t session() const { return session_; }            ///< first process of the last run
  [[nodiscard]] int output() const { return process_.output.get(); }  ///< to poll for reading; -1: none

 private:
  void launch(Clock::time_point now);
  void signal_all(int signal) const;
  void finish_stop(Clock::time_point now);
  void schedule_respawn(Clock::time_point now);

  CommandId id_;
  Command command_;
  std::string marker_;
  const CommandListener& listener_;
  CommandState state_ = CommandState::stopped;
  Outcome outcome_ = Outcome::none;
  int wait_status_ = 0;
  SpawnedProcess process_;
  pid_t session_ = 0;
  bool start_when_stopped_ = false;
  Clock::time_point started_;
  Clock::time_point deadline_;  ///< for SIGKILL while stopping, for the start while respawning
  Clock::duration respawn_pause_{};
};

/// "exit status 3", "signal 9 (Killed)".
std::string describe_wait_status(int wait_status);

}  // namespace eg::procman
