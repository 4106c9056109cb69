#include "common/procman/script_runner.hpp"

#include "common/base/check.hpp"

namespace eg::procman {
namespace {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;  // clang 14 does not find it by itself

const char* to_string(RunState state) { return state == RunState::running ? "running" : "stopped"; }

bool is_fulfilled(RunState wanted, Condition condition) {
  const bool ended = condition == Condition::ended_well || condition == Condition::failed;
  if (wanted == RunState::stopped) return ended || condition == Condition::not_started;
  // One that ran and ended well before anyone looked has been running.
  return condition == Condition::running || condition == Condition::ended_well;
}

}  // namespace

ScriptRunner::ScriptRunner(const Configuration& configuration, CommandSet& commands, const std::string& script,
                           Options options)
    : configuration_(configuration), commands_(commands), options_(options) {
  const Script* found = configuration.find_script(script);
  EG_CHECK(found != nullptr, "check_script() comes before running a script");
  stack_.push_back({found, 0});
}

base::Status ScriptRunner::step(Clock::time_point now) {
  while (!done()) {
    if (wait_) {
      const base::Result<bool> over = check_wait(now);
      if (!over) return tl::make_unexpected(over.error());
      if (!*over) return {};
      wait_.reset();
    }
    Position& position = stack_.back();
    if (position.next_action == position.script->actions.size()) {
      stack_.pop_back();
    } else {
      carry_out(position.script->actions[position.next_action++], now);
    }
  }
  return {};
}

void ScriptRunner::carry_out(const Action& action, Clock::time_point now) {
  std::visit(Overloaded{
                 [&](const ChangeAction& change) { carry_out(change, action.place, now); },
                 [&](const WaitTimeAction& wait) {
                   wait_ = Wait{{}, {}, now + wait.time, action.place};
                 },
                 [&](const WaitStatusAction& wait) { wait_for(wait.selection, wait.state, action.place, now); },
                 [&](const RunScriptAction& run) {
                   stack_.push_back({configuration_.find_script(run.script), 0});
                 },
             },
             action.what);
}

void ScriptRunner::carry_out(const ChangeAction& action, Place place, Clock::time_point now) {
  for (const std::size_t command : configuration_.select(action.selection)) {
    switch (action.verb) {
      case ChangeAction::Verb::start:
        commands_.start(command);
        break;
      case ChangeAction::Verb::stop:
        commands_.stop(command);
        break;
      case ChangeAction::Verb::restart:
        commands_.restart(command);
        break;
    }
  }
  if (action.wait) wait_for(action.selection, action.wait_state, place, now);
}

void ScriptRunner::wait_for(const Selection& selection, RunState wanted, Place place, Clock::time_point now) {
  std::vector<std::size_t> commands = configuration_.select(selection);
  if (!commands.empty()) wait_ = Wait{std::move(commands), wanted, now + options_.wait_limit, place};
}

base::Result<bool> ScriptRunner::check_wait(Clock::time_point now) const {
  if (wait_->commands.empty()) return now >= wait_->end;
  for (const std::size_t index : wait_->commands) {
    const Command& command = configuration_.commands[index];
    const std::string name = "command \"" + command.name + "\"";
    const Condition condition = commands_.condition(index);
    const bool starts_again = command.auto_respawn && condition == Condition::failed;
    if (wait_->wanted == RunState::running && condition == Condition::failed && !starts_again) {
      return fail(name + " is not running: it ended with an error");
    }
    if (is_fulfilled(wait_->wanted, condition)) continue;
    if (now < wait_->end) return false;
    return fail(name + " was not " + to_string(wait_->wanted) + " after " +
                std::to_string(options_.wait_limit.count()) + " ms");
  }
  return true;
}

tl::unexpected<base::Error> ScriptRunner::fail(const std::string& message) const {
  return fail_at(configuration_.file_name, wait_->place, message);
}

}  // namespace eg::procman
