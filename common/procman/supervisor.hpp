#pragma once

#include <map>
#include <vector>

#include "common/procman/command_set.hpp"
#include "common/procman/supervised_command.hpp"

namespace eg::procman {

/// Runs commands as children of this process, which becomes the child subreaper of all they start. One per process,
/// used by one thread; there must be no other children.
class Supervisor : public CommandSet {
 public:
  /// The commands are numbered from 0 in their order.
  Supervisor(const std::vector<Command>& commands, CommandListener listener);
  /// Kills what is still running.
  ~Supervisor() override;
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  CommandId add(Command command);
  /// The command must be stopped.
  void remove(CommandId command);
  void redefine(CommandId command, Command definition) { commands_.at(command).redefine(std::move(definition)); }

  void start(CommandId command) override;
  void stop(CommandId command) override;
  void restart(CommandId command) override;
  [[nodiscard]] Condition condition(CommandId command) const override;

  /// Waits at most `timeout` for output or the end of a process, and does what is due.
  void poll(std::chrono::milliseconds timeout);

  /// True if any command is running or about to.
  [[nodiscard]] bool busy() const;
  [[nodiscard]] const SupervisedCommand& at(CommandId command) const { return commands_.at(command); }
  [[nodiscard]] CommandState state(CommandId command) const { return at(command).state(); }
  [[nodiscard]] Outcome outcome(CommandId command) const { return at(command).outcome(); }
  [[nodiscard]] const Command& command(CommandId command) const { return at(command).command(); }
  [[nodiscard]] std::size_t size() const { return commands_.size(); }

  /// Stops all commands, the last started first, each when the one before it has stopped. `hurry` is asked meanwhile:
  /// once it is true, all is killed at once.
  void stop_all(const std::function<bool()>& hurry);

  /// SIGKILL to everything that descends from this process; returns when nothing is left.
  void kill_everything();

 private:
  void reap();
  void note_start(CommandId command);

  CommandListener listener_;
  std::map<CommandId, SupervisedCommand> commands_;
  CommandId next_id_ = 0;
  std::vector<CommandId> start_order_;
};

}  // namespace eg::procman
