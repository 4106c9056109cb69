#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/base/result.hpp"

/// Launching and supervising processes from procman configuration files (libbot2's grammar and behaviour).
namespace eg::procman {

/// Where in the file something was written; both count from 1.
struct Place {
  int line = 0;
  int column = 0;
};

/// More would not fit a clock's difference everywhere.
inline constexpr std::chrono::seconds kLongestStopTime{1'000'000};

/// One process to run.
struct Command {
  std::string name;
  std::string exec;   ///< shell-style words; see exec_line.hpp
  std::string host;   ///< deputy that runs it; may be empty
  std::string group;  ///< "outer/inner"; empty: none
  bool auto_respawn = false;
  int stop_signal = 2;                                                   ///< SIGINT
  std::chrono::milliseconds stop_time_allowed{std::chrono::seconds(7)};  ///< before SIGKILL
  Place place;
};

/// What an action is about.
struct Selection {
  enum class Kind { everything, command, group };
  Kind kind = Kind::everything;
  std::string name;  ///< of the command or group; a group includes its subgroups
};

enum class RunState { running, stopped };

/// start, stop or restart, and then perhaps wait.
struct ChangeAction {
  enum class Verb { start, stop, restart };
  Verb verb = Verb::start;
  Selection selection;
  bool wait = false;
  RunState wait_state = RunState::running;
};

struct WaitTimeAction {
  std::chrono::milliseconds time{0};
};

struct WaitStatusAction {
  Selection selection;
  RunState state = RunState::running;
};

struct RunScriptAction {
  std::string script;
};

struct Action {
  std::variant<ChangeAction, WaitTimeAction, WaitStatusAction, RunScriptAction> what;
  Place place;
};

struct Script {
  std::string name;
  std::vector<Action> actions;
  Place place;
};

struct Configuration {
  std::string file_name;  ///< for messages
  std::vector<Command> commands;
  std::vector<std::string> groups;  ///< full names, each once, in order of appearance; also empty ones
  std::vector<Script> scripts;

  [[nodiscard]] const Script* find_script(std::string_view name) const;

  /// Indices of the commands that a selection means, in order of appearance. Several commands may share a name.
  [[nodiscard]] std::vector<std::size_t> select(const Selection& selection) const;
};

/// Parses the text of a .pmd file. An error reads "file_name:line:column: what is wrong".
base::Result<Configuration> parse_configuration(std::string_view text, const std::string& file_name);

/// Reads and parses a .pmd file.
base::Result<Configuration> load_configuration(const std::filesystem::path& file);

/// Checks that all that a script names, directly or through run_script, exists and that no script runs itself. The
/// grammar alone allows such a script.
base::Status check_script(const Configuration& configuration, const std::string& script);

/// "file_name:line:column: message" as an error.
tl::unexpected<base::Error> fail_at(const std::string& file_name, Place place, const std::string& message);

}  // namespace eg::procman
