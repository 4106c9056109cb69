#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/procman/configuration.hpp"

namespace eg::procman {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr char kExample[] = R"(
group "g" {
  cmd "ticker" { exec = "bash -c 'while :; do echo t; sleep 1; done'"; host = "localhost"; stop_signal = 15; stop_time_allowed = 3; }
  group "sub" { cmd "oneshot" { exec = "FOO=bar bash -c 'echo $FOO'"; host = "localhost"; } }
}
cmd "resp" { exec = "false"; host = "localhost"; auto_respawn = "true"; }
script "go" { start cmd "oneshot" wait "stopped"; start group "g"; wait cmd "ticker" status "running";
  wait ms 500; restart cmd "ticker" wait "running"; stop group "g/sub"; run_script "down"; }
script "down" { stop everything wait "stopped"; }
)";

Configuration parse(const std::string& text) {
  const auto configuration = parse_configuration(text, "test.pmd");
  EXPECT_TRUE(configuration) << (configuration ? "" : configuration.error().message);
  return configuration.value_or(Configuration{});
}

std::string error_of(const std::string& text) {
  const auto configuration = parse_configuration(text, "test.pmd");
  return configuration ? "no error" : configuration.error().message;
}

TEST(Parser, ReadsCommandsWithTheirGroupsAndAttributes) {
  const Configuration configuration = parse(kExample);
  ASSERT_EQ(configuration.commands.size(), 3u);
  const Command& ticker = configuration.commands[0];
  EXPECT_EQ(ticker.name, "ticker");
  EXPECT_EQ(ticker.exec, "bash -c 'while :; do echo t; sleep 1; done'");
  EXPECT_EQ(ticker.host, "localhost");
  EXPECT_EQ(ticker.group, "g");
  EXPECT_EQ(ticker.stop_signal, 15);
  EXPECT_EQ(ticker.stop_time_allowed, std::chrono::seconds(3));
  EXPECT_FALSE(ticker.auto_respawn);
  EXPECT_EQ(ticker.place.line, 3);
  EXPECT_EQ(configuration.commands[1].group, "g/sub");
  EXPECT_EQ(configuration.commands[1].stop_signal, 2);
  EXPECT_EQ(configuration.commands[1].stop_time_allowed, std::chrono::seconds(7));
  EXPECT_EQ(configuration.commands[2].group, "");
  EXPECT_TRUE(configuration.commands[2].auto_respawn);
  EXPECT_THAT(configuration.groups, ElementsAre("g", "g/sub"));
}

TEST(Parser, ReadsEveryKindOfAction) {
  const Configuration configuration = parse(kExample);
  const Script* go = configuration.find_script("go");
  ASSERT_NE(go, nullptr);
  ASSERT_EQ(go->actions.size(), 7u);
  const auto start = std::get<ChangeAction>(go->actions[0].what);
  EXPECT_EQ(start.verb, ChangeAction::Verb::start);
  EXPECT_EQ(start.selection.kind, Selection::Kind::command);
  EXPECT_TRUE(start.wait);
  EXPECT_EQ(start.wait_state, RunState::stopped);
  EXPECT_FALSE(std::get<ChangeAction>(go->actions[1].what).wait);
  EXPECT_EQ(std::get<WaitStatusAction>(go->actions[2].what).selection.name, "ticker");
  EXPECT_EQ(std::get<WaitTimeAction>(go->actions[3].what).time, std::chrono::milliseconds(500));
  EXPECT_EQ(std::get<ChangeAction>(go->actions[4].what).verb, ChangeAction::Verb::restart);
  EXPECT_EQ(std::get<ChangeAction>(go->actions[5].what).selection.kind, Selection::Kind::group);
  EXPECT_EQ(std::get<RunScriptAction>(go->actions[6].what).script, "down");
  const Script* down = configuration.find_script("down");
  ASSERT_NE(down, nullptr);
  EXPECT_EQ(std::get<ChangeAction>(down->actions[0].what).selection.kind, Selection::Kind::everything);
}

TEST(Parser, AGroupIncludesItsSubgroupsButNotItsNamesakes) {
  const Configuration configuration = parse(R"(
    group "a" { cmd "1" { exec = "x"; } group "b" { cmd "2" { exec = "x"; } } }
    group "ab" { cmd "3" { exec = "x"; } }
    cmd "4" { group = "a"; exec = "x"; })");
  EXPECT_THAT(configuration.select({Selection::Kind::group, "a"}), ElementsAre(0, 1, 3));
  EXPECT_THAT(configuration.select({Selection::Kind::group, "a/b"}), ElementsAre(1));
  EXPECT_THAT(configuration.select({Selection::Kind::everything, ""}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(configuration.select({Selection::Kind::command, "3"}), ElementsAre(2));
}

TEST(Parser, AcceptsWhatUpstreamAccepts) {
  EXPECT_EQ(error_of(""), "no error");
  EXPECT_EQ(error_of("# only a comment"), "no error");
  EXPECT_EQ(error_of("group \"empty\" {}"), "no error");
  EXPECT_EQ(error_of("script \"a/b\" {}"), "no error");
  EXPECT_THAT(parse("group \"g\" { } group \"g\" { cmd \"c\" { exec = \"x\"; } }").groups, ElementsAre("g"));
  EXPECT_EQ(parse("group \"g\" { cmd \"c\" { group = \"other\"; exec = \"x\"; } }").commands[0].group, "g");
  EXPECT_EQ(parse("cmd \"c\" { exec = \"x\"; group = \"other\"; }").commands[0].group, "other");
  for (const char* yes : {"true", "TRUE", "yes", "Yes"}) {
    EXPECT_TRUE(
        parse(std::string("cmd \"c\" { exec = \"x\"; auto_respawn = \"") + yes + "\"; }").commands[0].auto_respawn);
  }
  EXPECT_FALSE(parse("cmd \"c\" { exec = \"x\"; auto_respawn = \"on\"; }").commands[0].auto_respawn);
  EXPECT_EQ(parse(R"(cmd "c" { exec = "a\tb\n\"\\\q"; })").commands[0].exec, "a\tb\n\"\\q");
}

struct Rejected {
  const char* text;
  const char* place;
  const char* what;
};

class ParserRejects : public testing::TestWithParam<Rejected> {};

TEST_P(ParserRejects, WithThePlace) {
  const std::string error = error_of(GetParam().text);
  EXPECT_THAT(error, testing::StartsWith(std::string("test.pmd:") + GetParam().place + ": "));
  EXPECT_THAT(error, HasSubstr(GetParam().what));
}

INSTANTIATE_TEST_SUITE_P(
    All, ParserRejects,
    testing::Values(Rejected{"cmd \"a/b\" { exec = \"x\"; }", "1:5", "'/'"}, Rejected{"group \"a/b\" {}", "1:7", "'/'"},
                    Rejected{"group \"\" {}", "1:7", "empty"},
                    Rejected{"group \"g\" { script \"s\" {} }", "1:13", "script"},
                    Rejected{"script \"s\" { wait everything status \"running\"; }", "1:19", "everything"},
                    Rejected{"cmd \"c\" { exec = \"x\"; stop_time_allowed = 1.5; }", "1:43", "integer"},
                    Rejected{"cmd \"c\" { exec = \"x\", }", "1:21", "','"},
                    Rejected{"cmd \"c\" {\n exec = \"x\"\n}", "3:1", "expected ';'"},
                    Rejected{"cmd \"c\" { exec = \"x\"; nice = 3; }", "1:23", "unknown attribute 'nice'"},
                    Rejected{"script \"s\" {}\nscript \"s\" {}", "2:8", "already"},
                    Rejected{"cmd \"c\" { host = \"x\"; }", "1:23", "no exec"},
                    Rejected{"cmd \"c\" { exec = \"x\"; stop_signal = 0; }", "1:37", "in [1, 64]"},
                    Rejected{"cmd \"c\" { exec = \"x\"; stop_signal = 99999999999; }", "1:37", "in [1, 64]"},
                    Rejected{"cmd \"c\" { exec = \"x\"; stop_signal = 65; }", "1:37", "in [1, 64]"},
                    Rejected{"cmd \"c\" { exec = \"x\"; stop_time_allowed = 1000001; }", "1:43", "in [1, 1000000]"},
                    Rejected{"cmd \"c\" { exec = \"x\"; stop_signal = \"2\"; }", "1:37", "stop_signal"},
                    Rejected{"cmd \"c\" { exec = 7; }", "1:18", "string"},
                    Rejected{"cmd \"c\" { exec = \"x\n\"; }", "1:18", "does not end"},
                    Rejected{"script \"s\" { start cmd \"c\" wait \"asleep\"; }", "1:33", "asleep"},
                    Rejected{"script \"s\" { run cmd \"c\"; }", "1:14", "run"},
                    Rejected{"script \"s\" { wait ms \"5\"; }", "1:22", "milliseconds"},
                    Rejected{"cmd \"c\" { exec = \"x\";", "1:22", "end of the file"},
                    Rejected{"include \"x\"", "1:1", "include"}));

TEST(Parser, SurvivesEveryTruncationOfAFile) {
  const std::string text = kExample;
  for (std::size_t length = 0; length < text.size(); ++length) {
    const auto configuration = parse_configuration(text.substr(0, length), "test.pmd");
    if (!configuration) {
      EXPECT_THAT(configuration.error().message, testing::StartsWith("test.pmd:"));
    }
  }
}

TEST(CheckScript, FindsUnknownNamesAndEndlessScripts) {
  const Configuration configuration = parse(R"(
cmd "c" { exec = "x"; }
script "good" { start cmd "c"; run_script "also good"; run_script "also good"; }
script "also good" { stop everything; }
script "command" { start cmd "d"; }
script "group" { start group "g"; }
script "deep" { run_script "command"; }
script "self" { run_script "circle"; }
script "circle" { run_script "self"; })");
  EXPECT_TRUE(check_script(configuration, "good"));
  EXPECT_EQ(check_script(configuration, "command").error().message, "test.pmd:5:20: there is no command \"d\"");
  EXPECT_EQ(check_script(configuration, "group").error().message, "test.pmd:6:18: there is no group \"g\"");
  EXPECT_EQ(check_script(configuration, "deep").error().message, "test.pmd:5:20: there is no command \"d\"");
  EXPECT_THAT(check_script(configuration, "self").error().message, HasSubstr("without end"));
  EXPECT_EQ(check_script(configuration, "none").error().message, "test.pmd: there is no script \"none\"");
}

TEST(LoadConfiguration, LoadsEveryFileThatIsShipped) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(EGRAPH_SOURCE_DIR "/procman")) {
    if (entry.path().extension() != ".pmd") continue;
    ++files;
    const auto configuration = load_configuration(entry.path());
    ASSERT_TRUE(configuration) << configuration.error().message;
    for (const Script& script : configuration->scripts) {
      const auto status = check_script(*configuration, script.name);
      EXPECT_TRUE(status) << status.error().message;
    }
  }
  EXPECT_GT(files, 0);
}

TEST(LoadConfiguration, NamesAFileThatIsNotThere) {
  EXPECT_THAT(load_configuration("/nowhere/x.pmd").error().message, HasSubstr("/nowhere/x.pmd"));
  EXPECT_THAT(load_configuration("/proc").error().message, HasSubstr("/proc"));  // a folder
}

}  // namespace
}  // namespace eg::procman
