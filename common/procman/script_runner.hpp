#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/procman/command_set.hpp"
#include "common/procman/configuration.hpp"
#include "common/procman/now.hpp"

namespace eg::procman {

/// Carries out a script step by step while its caller keeps the commands going.
class ScriptRunner {
 public:
  struct Options {
    std::chrono::milliseconds wait_limit{30000};  ///< for each `wait` on a status; upstream's have none
  };

  /// The script must have passed check_script().
  ScriptRunner(const Configuration& configuration, CommandSet& commands, const std::string& script, Options options);

  /// Goes on as far as possible without waiting. An error: a wait took too long or cannot be fulfilled any more.
  base::Status step(Clock::time_point now);

  [[nodiscard]] bool done() const { return stack_.empty(); }

 private:
  struct Position {
    const Script* script;
    std::size_t next_action;
  };
  struct Wait {
    std::vector<std::size_t> commands;  ///< none: just the time
    RunState wanted = RunState::running;
    Clock::time_point end;
    Place place;
  };

  void carry_out(const Action& action, Clock::time_point now);
  void carry_out(const ChangeAction& action, Place place, Clock::time_point now);
  void wait_for(const Selection& selection, RunState wanted, Place place, Clock::time_point now);
  /// Whether `wait_` is over.
  base::Result<bool> check_wait(Clock::time_point now) const;
  [[nodiscard]] tl::unexpected<base::Error> fail(const std::string& message) const;

  const Configuration& configuration_;
  CommandSet& commands_;
  Options options_;
  std::vector<Position> stack_;
  std::optional<Wait> wait_;
};

}  // namespace eg::procman
