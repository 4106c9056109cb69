#pragma once

#include <cstddef>

namespace eg::procman {

/// How things stand with a command, as a script sees it.
enum class Condition {
  changing,     ///< starting, stopping, about to be started again, or not known
  running,      ///< its first process runs
  not_started,  ///< not running, and was not
  ended_well,   ///< not running; the last run ended as it should
  failed,       ///< not running; the last run ended with an error or could not begin
};

/// The commands of a configuration, numbered as there, however they are run.
class CommandSet {
 public:
  virtual ~CommandSet() = default;

  virtual void start(std::size_t command) = 0;
  virtual void stop(std::size_t command) = 0;
  virtual void restart(std::size_t command) = 0;
  [[nodiscard]] virtual Condition condition(std::size_t command) const = 0;
};

}  // namespace eg::procman
