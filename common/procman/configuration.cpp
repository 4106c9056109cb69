#include "common/procman/configuration.hpp"

#include <algorithm>
#include <fstream>

#include "common/base/read_stream.hpp"

namespace eg::procman {
namespace {

bool is_in_group(const Command& command, const std::string& group) {
  return command.group == group || command.group.starts_with(group + "/");
}

bool selects(const Selection& selection, const Command& command) {
  switch (selection.kind) {
    case Selection::Kind::everything:
      return true;
    case Selection::Kind::command:
      return command.name == selection.name;
    case Selection::Kind::group:
      return is_in_group(command, selection.name);
  }
  return false;
}

/// Follows run_script and checks every name on the way.
class ScriptChecker {
 public:
  explicit ScriptChecker(const Configuration& configuration) : configuration_(configuration) {}

  base::Status check(const Script& script) {
    running_.push_back(&script);
    for (const Action& action : script.actions) {
      place_ = action.place;
      if (base::Status status = std::visit([&](const auto& what) { return check(what); }, action.what); !status) {
        return status;
      }
    }
    running_.pop_back();
    return {};
  }

 private:
  base::Status check(const ChangeAction& action) { return check(action.selection); }
  base::Status check(const WaitTimeAction& /*action*/) { return {}; }
  base::Status check(const WaitStatusAction& action) { return check(action.selection); }

  base::Status check(const RunScriptAction& action) {
    const Script* script = configuration_.find_script(action.script);
    if (script == nullptr) return fail("there is no script \"" + action.script + "\"");
    if (std::find(running_.begin(), running_.end(), script) != running_.end()) {
      return fail("script \"" + action.script + "\" would run itself without end");
    }
    return check(*script);
  }

  base::Status check(const Selection& selection) {
    const auto& groups = configuration_.groups;
    switch (selection.kind) {
      case Selection::Kind::everything:
        return {};
      case Selection::Kind::command:
        if (configuration_.select(selection).empty()) return fail("there is no command \"" + selection.name + "\"");
        return {};
      case Selection::Kind::group:
        if (std::find(groups.begin(), groups.end(), selection.name) == groups.end()) {
          return fail("there is no group \"" + selection.name + "\"");
        }
        return {};
    }
    return {};
  }

  base::Status fail(const std::string& message) { return fail_at(configuration_.file_name, place_, message); }

  const Configuration& configuration_;
  std::vector<const Script*> running_;
  Place place_;
};

}  // namespace

const Script* Configuration::find_script(std::string_view name) const {
  const auto found =
      std::find_if(scripts.begin(), scripts.end(), [&](const Script& script) { return script.name == name; });
  return found == scripts.end() ? nullptr : &*found;
}

std::vector<std::size_t> Configuration::select(const Selection& selection) const {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (selects(selection, commands[i])) indices.push_back(i);
  }
  return indices;
}

base::Result<Configuration> load_configuration(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return base::fail("cannot read the procman configuration " + file.string());
  const std::string text = base::read_stream(stream);
  if (stream.bad()) return base::fail("cannot read the procman configuration " + file.string());
  return parse_configuration(text, file.string());
}

base::Status check_script(const Configuration& configuration, const std::string& script) {
  const Script* found = configuration.find_script(script);
  if (found == nullptr) return base::fail(configuration.file_name + ": there is no script \"" + script + "\"");
  return ScriptChecker(configuration).check(*found);
}

tl::unexpected<base::Error> fail_at(const std::string& file_name, Place place, const std::string& message) {
  return base::fail(file_name + ":" + std::to_string(place.line) + ":" + std::to_string(place.column) + ": " + message);
}

}  // namespace eg::procman
