#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <utility>

#include "common/procman/configuration.hpp"
#include "common/procman/lexer.hpp"

namespace eg::procman {
namespace {

/// Thrown inside the parser only: recursive descent reads better without a check after every token.
struct SyntaxError {
  base::Error error;
};

bool is_true(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text == "true" || text == "yes";
}

/// Recursive descent over the grammar in docs/running.md, with one token of look-ahead.
class Parser {
 public:
  Parser(std::string_view text, const std::string& file_name) : lexer_(text, file_name) {
    configuration_.file_name = file_name;
    advance();
  }

  Configuration parse_file() {
    while (token_.kind != Token::Kind::end) {
      if (take_keyword("cmd")) {
        parse_command("");
      } else if (take_keyword("group")) {
        parse_group("");
      } else if (take_keyword("script")) {
        parse_script();
      } else {
        fail("expected cmd, group or script, found " + describe(token_));
      }
    }
    return std::move(configuration_);
  }

 private:
  void advance() {
    auto token = lexer_.next();
    if (!token) throw SyntaxError{token.error()};
    token_ = std::move(*token);
  }

  [[noreturn]] void fail_at_place(Place place, const std::string& message) {
    throw SyntaxError{fail_at(configuration_.file_name, place, message).value()};
  }
  [[noreturn]] void fail(const std::string& message) { fail_at_place(token_.place, message); }

  bool take_keyword(std::string_view word) {
    if (token_.kind != Token::Kind::identifier || token_.text != word) return false;
    advance();
    return true;
  }

  Token take(Token::Kind kind, const std::string& expected) {
    if (token_.kind != kind) fail("expected " + expected + ", found " + describe(token_));
    Token token = token_;
    advance();
    return token;
  }

  std::string take_string(const std::string& expected) { return take(Token::Kind::string, expected).text; }

  int take_integer(const std::string& expected, int low, int high) {
    const Token token = take(Token::Kind::integer, expected);
    int value = 0;
    const char* end = token.text.data() + token.text.size();
    if (std::from_chars(token.text.data(), end, value).ec != std::errc{} || value < low || value > high) {
      fail_at_place(token.place, expected + " must be in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
    }
    return value;
  }

  std::string take_plain_name(const std::string& what) {
    const Token token = take(Token::Kind::string, "the name of the " + what + " in quotes");
    if (token.text.find('/') != std::string::npos) fail_at_place(token.place, "'/' in the name of a " + what);
    return token.text;
  }

  void add_group(const std::string& group) {
    auto& groups = configuration_.groups;
    if (!group.empty() && std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
  }

  void parse_group(const std::string& enclosing) {
    const Place place = token_.place;
    const std::string name = take_plain_name("group");
    if (name.empty()) fail_at_place(place, "the name of a group must not be empty");
    const std::string group = enclosing.empty() ? name : enclosing + "/" + name;
    add_group(group);
    take(Token::Kind::open_brace, "'{'");
    while (token_.kind != Token::Kind::close_brace) {
      if (take_keyword("cmd")) {
        parse_command(group);
      } else if (take_keyword("group")) {
        parse_group(group);
      } else {
        fail("expected cmd, group or '}', found " + describe(token_));
      }
    }
    advance();
  }

  void parse_command(const std::string& enclosing_group) {
    Command command;
    command.place = token_.place;
    command.name = take_plain_name("command");
    take(Token::Kind::open_brace, "'{'");
    while (token_.kind != Token::Kind::close_brace) parse_attribute(command);
    if (command.exec.empty()) fail("command \"" + command.name + "\" has no exec");
    advance();
    if (!enclosing_group.empty()) command.group = enclosing_group;
    add_group(command.group);
    configuration_.commands.push_back(std::move(command));
  }

  void parse_attribute(Command& command) {
    const Token name = take(Token::Kind::identifier, "an attribute or '}'");
    take(Token::Kind::assign, "'='");
    if (name.text == "exec") {
      command.exec = take_string("a string in quotes");
    } else if (name.text == "host") {
      command.host = take_string("a string in quotes");
    } else if (name.text == "group") {
      command.group = take_string("a string in quotes");
    } else if (name.text == "auto_respawn") {
      command.auto_respawn = is_true(take_string("\"true\" or \"false\""));
    } else if (name.text == "stop_signal") {
      command.stop_signal = take_integer("stop_signal", 1, SIGRTMAX);
    } else if (name.text == "stop_time_allowed") {
      command.stop_time_allowed =
          std::chrono::seconds(take_integer("stop_time_allowed", 1, static_cast<int>(kLongestStopTime.count())));
    } else {
      fail_at_place(name.place, "unknown attribute '" + name.text +
                                    "' (known: exec, host, group, auto_respawn, stop_signal, stop_time_allowed)");
    }
    take(Token::Kind::semicolon, "';'");
  }

  void parse_script() {
    Script script;
    script.place = token_.place;
    script.name = take_string("the name of the script in quotes");
    if (configuration_.find_script(script.name) != nullptr) {
      fail_at_place(script.place, "there is already a script \"" + script.name + "\"");
    }
    take(Token::Kind::open_brace, "'{'");
    while (token_.kind != Token::Kind::close_brace) script.actions.push_back(parse_action());
    advance();
    configuration_.scripts.push_back(std::move(script));
  }

  Action parse_action() {
    Action action;
    action.place = token_.place;
    if (take_keyword("start")) {
      action.what = parse_change(ChangeAction::Verb::start);
    } else if (take_keyword("stop")) {
      action.what = parse_change(ChangeAction::Verb::stop);
    } else if (take_keyword("restart")) {
      action.what = parse_change(ChangeAction::Verb::restart);
    } else if (take_keyword("run_script")) {
      action.what = RunScriptAction{take_string("the name of a script in quotes")};
    } else if (take_keyword("wait")) {
      parse_wait(action);
    } else {
      fail("expected start, stop, restart, wait, run_script or '}', found " + describe(token_));
    }
    take(Token::Kind::semicolon, "';'");
    return action;
  }

  ChangeAction parse_change(ChangeAction::Verb verb) {
    ChangeAction change;
    change.verb = verb;
    if (!take_keyword("everything")) change.selection = parse_selection("everything, cmd or group");
    if (take_keyword("wait")) {
      change.wait = true;
      change.wait_state = parse_run_state();
    }
    return change;
  }

  void parse_wait(Action& action) {
    if (take_keyword("ms")) {
      action.what = WaitTimeAction{std::chrono::milliseconds(take_integer("the time in milliseconds", 0, INT32_MAX))};
      return;
    }
    WaitStatusAction wait;
    wait.selection = parse_selection("ms, cmd or group");
    if (!take_keyword("status")) fail("expected status, found " + describe(token_));
    wait.state = parse_run_state();
    action.what = wait;
  }

  Selection parse_selection(const std::string& expected) {
    if (take_keyword("cmd")) return {Selection::Kind::command, take_string("the name of a command in quotes")};
    if (take_keyword("group")) return {Selection::Kind::group, take_string("the name of a group in quotes")};
    fail("expected " + expected + ", found " + describe(token_));
  }

  RunState parse_run_state() {
    const Token token = take(Token::Kind::string, "\"running\" or \"stopped\"");
    if (token.text == "running") return RunState::running;
    if (token.text == "stopped") return RunState::stopped;
    fail_at_place(token.place, "expected \"running\" or \"stopped\", found " + describe(token));
  }

  Lexer lexer_;
  Token token_;
  Configuration configuration_;
};

}  // namespace

base::Result<Configuration> parse_configuration(std::string_view text, const std::string& file_name) {
  try {
    return Parser(text, file_name).parse_file();
  } catch (const SyntaxError& failure) {
    return tl::make_unexpected(failure.error);
  }
}

}  // namespace eg::procman
