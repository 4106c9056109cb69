#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

/// The program procman-sheriff in its lone-ranger form, as a process.
namespace eg {
namespace {

using namespace std::chrono_literals;
using test::Program;
using testing::HasSubstr;
using testing::Not;

class LoneRanger : public testing::Test {
 protected:
  void TearDown() override { EXPECT_TRUE(test::no_process_is_left()); }

  /// Arguments that run `text`.
  std::vector<std::string> arguments(const std::string& text, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"--lone-ranger", folder_.write("test.pmd", text).string()});
    return more;
  }

  test::TemporaryFolder folder_;
};

TEST_F(LoneRanger, RunsAScriptAndEndsWithItsCommands) {
  Program sheriff("procman-sheriff", arguments(R"(
    cmd "one" { exec = "bash -c 'sleep 0.2; echo first'"; host = "localhost"; }
    cmd "two" { exec = "echo second"; host = "localhost"; }
    cmd "three" { exec = "echo third"; host = "localhost"; }
    script "go" { start cmd "one" wait "stopped"; start cmd "two" wait "stopped"; })",
                                               {"go"}));
  EXPECT_EQ(sheriff.wait(30s), 0);
  const std::string output = sheriff.output();
  EXPECT_LT(output.find("[one] first"), output.find("[two] second"));
  EXPECT_THAT(output, HasSubstr("[two] second"));
  EXPECT_THAT(output, Not(HasSubstr("third")));
}

TEST_F(LoneRanger, StartsEverythingWithoutAScript) {
  Program sheriff("procman-sheriff", arguments("cmd \"a\" { exec = \"echo A\"; } cmd \"b\" { exec = \"echo B\"; }"));
  EXPECT_EQ(sheriff.wait(30s), 0);
  EXPECT_THAT(sheriff.output(), testing::AllOf(HasSubstr("[a] A"), HasSubstr("[b] B")));
}

class LoneRangerSignals : public LoneRanger, public testing::WithParamInterface<int> {};

TEST_P(LoneRangerSignals, StopsEverythingAndEndsWell) {
  Program sheriff("procman-sheriff",
                  arguments("cmd \"a\" { exec = \"bash -c 'sleep 1000 & echo up; wait'\"; auto_respawn = \"true\"; }"));
  ASSERT_TRUE(sheriff.wait_for_output("[a] up"));
  sheriff.send_signal(GetParam());
  EXPECT_EQ(sheriff.wait(30s), 0);
  EXPECT_TRUE(test::no_process_is_left(0s));
}

INSTANTIATE_TEST_SUITE_P(All, LoneRangerSignals, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT));

TEST_F(LoneRanger, ASecondSignalKillsWhatTakesItsTime) {
  Program sheriff("procman-sheriff",
                  arguments("cmd \"a\" { exec = \"bash -c 'trap : INT; echo up; while :; do sleep 0.05; done'\"; "
                            "stop_time_allowed = 1000; }"));
  ASSERT_TRUE(sheriff.wait_for_output("[a] up"));
  sheriff.send_signal(SIGINT);
  EXPECT_EQ(sheriff.wait(1s), -1);
  sheriff.send_signal(SIGINT);
  EXPECT_EQ(sheriff.wait(10s), 0);
}

TEST_F(LoneRanger, ItsCommandsDieWithIt) {
  Program sheriff("procman-sheriff", arguments("cmd \"a\" { exec = \"bash -c 'echo up; sleep 1000; true'\"; }"));
  ASSERT_TRUE(sheriff.wait_for_output("[a] up"));
  sheriff.send_signal(SIGKILL);
  EXPECT_EQ(sheriff.wait(30s), 128 + SIGKILL);
}

TEST_F(LoneRanger, ReportsACommandThatFails) {
  Program sheriff("procman-sheriff", arguments("cmd \"a\" { exec = \"bash -c 'exit 3'\"; }"));
  EXPECT_EQ(sheriff.wait(30s), 1);
  EXPECT_THAT(sheriff.output(), HasSubstr("error: a ended with exit status 3"));
}

TEST_F(LoneRanger, AWaitThatTakesTooLongEndsTheRun) {
  const std::string text = "cmd \"a\" { exec = \"sleep 1000\"; }\nscript \"go\" { start cmd \"a\" wait \"stopped\"; }";
  Program sheriff("procman-sheriff", arguments(text, {"go", "--wait-limit", "0.2"}));
  EXPECT_EQ(sheriff.wait(30s), 1);
  EXPECT_THAT(sheriff.output(), HasSubstr("test.pmd:2:15: command \"a\" was not stopped after 200 ms"));
}

struct Refused {
  const char* text;
  const char* script;
  const char* message;
};

class LoneRangerRefuses : public LoneRanger, public testing::WithParamInterface<Refused> {};

TEST_P(LoneRangerRefuses, WhatItCannotRun) {
  Program sheriff("procman-sheriff", arguments(GetParam().text, {GetParam().script}));
  EXPECT_EQ(sheriff.wait(30s), 1);
  EXPECT_THAT(sheriff.output(), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, LoneRangerRefuses,
    testing::Values(Refused{"cmd \"a\" { exec = \"x\" }", "s", "test.pmd:1:22: expected ';'"},
                    Refused{"cmd \"a\" { exec = \"x\"; }", "s", "there is no script \"s\""},
                    Refused{"script \"s\" { start cmd \"a\"; }", "s", "test.pmd:1:14: there is no command \"a\""},
                    Refused{"cmd \"a\" { exec = \"x\"; host = \"robot\"; } script \"s\" {}", "s",
                            "test.pmd:1:5: command \"a\" is for host \"robot\""},
                    Refused{"cmd \"a\" { exec = \"/no/such/program\"; } script \"s\" { start everything; }", "s",
                            "a could not be started: cannot run /no/such/program: No such file or directory"}));

}  // namespace
}  // namespace eg
