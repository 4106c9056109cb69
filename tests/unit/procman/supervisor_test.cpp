#include "common/procman/supervisor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <map>
#include <optional>

#include "common/procman/line_splitter.hpp"
#include "common/procman/process_tree.hpp"
#include "common/procman/script_runner.hpp"

namespace eg::procman {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Command command(const std::string& name, const std::string& exec) {
  Command made;
  made.name = name;
  made.exec = exec;
  made.stop_time_allowed = 1s;
  return made;
}

/// Runs commands and remembers what they said.
class SupervisorTest : public testing::Test {
 protected:
  Supervisor& make(const std::vector<Command>& commands) {
    supervisor_.emplace(commands,
                        CommandListener{[this](CommandId id, std::string_view bytes) { output_[id].add(bytes, keep_); },
                                        [this](CommandId id, const std::string&) { output_[id].flush(keep_); },
                                        [this](CommandId id, const std::string& problem) {
                                          problems_.push_back(supervisor_->command(id).name + " " + problem);
                                        }});
    return *supervisor_;
  }

  template <typename Condition>
  bool poll_until(Condition condition, std::chrono::milliseconds limit = 5s) {
    const auto end = Clock::now() + limit;
    while (!condition() && Clock::now() < end) supervisor_->poll(10ms);
    return condition();
  }

  void TearDown() override {
    supervisor_.reset();
    EXPECT_THAT(find_descendants(getpid()), IsEmpty());
  }

  std::optional<Supervisor> supervisor_;
  LineSplitter::OnLine keep_ = [this](const std::string& line) { lines_.push_back(line); };
  std::map<CommandId, LineSplitter> output_;
  std::vector<std::string> lines_;
  std::vector<std::string> problems_;
};

bool never() { return false; }

TEST_F(SupervisorTest, RunsACommandAndPassesItsLinesOn) {
  Supervisor& supervisor = make({command("a", "FOO=bar bash -c 'echo $FOO; echo err >&2; printf unfinished'")});
  supervisor.start(0);
  EXPECT_EQ(supervisor.state(0), CommandState::running);
  ASSERT_TRUE(poll_until([&] { return !supervisor.busy(); }));
  EXPECT_THAT(lines_, ElementsAre("bar", "err", "unfinished"));
  EXPECT_EQ(supervisor.outcome(0), Outcome::ok);
}

TEST_F(SupervisorTest, ReportsAnExitWithError) {
  Supervisor& supervisor = make({command("a", "bash -c 'exit 3'"), command("b", "bash -c 'kill -9 $$'"),
                                 command("c", "bash -c 'kill -40 $$'")});  // which has no description
  for (const CommandId id : {0, 1, 2}) {
    supervisor.start(id);
    ASSERT_TRUE(poll_until([&] { return !supervisor.busy(); }));
  }
  EXPECT_THAT(problems_,
              ElementsAre("a ended with exit status 3", "b ended with signal 9 (Killed)", "c ended with signal 40"));
  EXPECT_EQ(supervisor.outcome(0), Outcome::error);
}

TEST_F(SupervisorTest, ReportsAProgramThatDoesNotExist) {
  Supervisor& supervisor = make({command("a", "/no/such/program"), command("b", "x 'y")});
  supervisor.start(0);
  supervisor.start(1);
  EXPECT_FALSE(supervisor.busy());
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("/no/such/program: No such file"), HasSubstr("quote")));
}

TEST_F(SupervisorTest, StopsWithTheStopSignal) {
  Command gentle = command("a", "bash -c 'trap \"echo bye; exit 0\" TERM; echo up; while :; do sleep 0.05; done'");
  gentle.stop_signal = SIGTERM;
  Supervisor& supervisor = make({gentle});
  supervisor.start(0);
  ASSERT_TRUE(poll_until([&] { return !lines_.empty(); }));
  supervisor.stop(0);
  ASSERT_TRUE(poll_until([&] { return !supervisor.busy(); }));
  EXPECT_THAT(lines_, Contains("bye"));
  EXPECT_EQ(supervisor.outcome(0), Outcome::ok);
}

TEST_F(SupervisorTest, KillsWhatDoesNotStopInTime) {
  Supervisor& supervisor = make({command("a", "bash -c 'trap : INT; echo up; while :; do sleep 0.05; done'")});
  supervisor.start(0);
  ASSERT_TRUE(poll_until([&] { return !lines_.empty(); }));
  const auto begin = Clock::now();
  supervisor.stop(0);
  ASSERT_TRUE(poll_until([&] { return !supervisor.busy(); }));
  EXPECT_GE(Clock::now() - begin, 1s);
  EXPECT_LE(Clock::now() - begin, 2s);
  EXPECT_EQ(supervisor.outcome(0), Outcome::error);
}

TEST_F(SupervisorTest, StopsOrphansAndDaemonsOfACommand) {
  Supervisor& supervisor =
      make({command("a", "bash -c '(setsid sleep 1000 &); (sleep 1000 &); trap \"\" HUP; echo up; sleep 1000'")});
  supervisor.start(0);
  ASSERT_TRUE(poll_until([&] { return find_descendants(getpid()).size() >= 3; }));
  supervisor.stop(0);
  ASSERT_TRUE(poll_until([&] { return !supervisor.busy(); }));
  EXPECT_THAT(find_descendants(getpid()), IsEmpty());
}

TEST_F(SupervisorTest, LeavesNothingOfACommandThatEndsByItself) {
  Supervisor& supervisor = make({command("a", "bash -c '(setsid sleep 1000 &) ; sleep 0.1'")});
  supervisor.start(0);
  ASSERT_TRUE(poll_until([&] { return !supervisor.busy(); }));
  EXPECT_TRUE(poll_until([&] { return find_descendants(getpid()).empty(); }));
}

TEST_F(SupervisorTest, AStopRightAfterAStartStopsTheCommandOnly) {
  Supervisor& supervisor = make({command("a", "sleep 1000"), command("b", "sleep 1000")});
  supervisor.start(1);
  for (int i = 0; i < 20; ++i) {
    supervisor.start(0);
    supervisor.stop(0);
    ASSERT_TRUE(poll_until([&] { return supervisor.state(0) == CommandState::stopped; }));
  }
  EXPECT_EQ(supervisor.state(1), CommandState::running);
}

TEST_F(SupervisorTest, RespawnsWithGrowingPausesUntilStopped) {
  Command flaky = command("a", "bash -c 'echo up; exit 1'");
  flaky.auto_respawn = true;
  Supervisor& supervisor = make({flaky});
  supervisor.start(0);
  ASSERT_TRUE(poll_until([&] { return lines_.size() >= 5; }));
  // The pauses before starts 2 to 5 are 10, 20, 40 and 80 ms; after 1.2 s at most the 7 of 10 to 640 ms have passed.
  EXPECT_FALSE(poll_until([&] { return lines_.size() > 8; }, 1s));
  supervisor.stop(0);
  EXPECT_TRUE(poll_until([&] { return !supervisor.busy(); }));
}

TEST_F(SupervisorTest, RestartsIntoANewProcess) {
  Supervisor& supervisor = make({command("a", "bash -c 'echo $$; exec sleep 1000'")});
  supervisor.start(0);
  ASSERT_TRUE(poll_until([&] { return lines_.size() == 1; }));
  supervisor.restart(0);
  ASSERT_TRUE(poll_until([&] { return lines_.size() == 2; }));
  EXPECT_NE(lines_[0], lines_[1]);
  EXPECT_EQ(supervisor.state(0), CommandState::running);
}

TEST_F(SupervisorTest, StopsTheLastStartedFirst) {
  const std::string say = "bash -c 'trap \"echo NAME; exit 0\" INT; echo up; while :; do sleep 0.02; done'";
  const auto talker = [&](const std::string& name) {
    std::string exec = say;
    return command(name, exec.replace(exec.find("NAME"), 4, name));
  };
  Supervisor& supervisor = make({talker("one"), talker("two"), talker("three")});
  for (const std::size_t i : {2u, 0u, 1u}) supervisor.start(i);
  ASSERT_TRUE(poll_until([&] { return lines_.size() == 3; }));
  lines_.clear();
  supervisor.stop_all(never);
  EXPECT_THAT(lines_, ElementsAre("two", "one", "three"));
}

class ScriptRunnerTest : public SupervisorTest {
 protected:
  /// Runs script "s" to its end; the error if it fails.
  std::string run(const std::string& text, std::chrono::milliseconds wait_limit = 5s) {
    const auto configuration = parse_configuration(text, "test.pmd");
    if (!configuration) return configuration.error().message;
    Supervisor& supervisor = make(configuration->commands);
    ScriptRunner runner(*configuration, supervisor, "s", {wait_limit});
    while (!runner.done()) {
      if (const auto status = runner.step(Clock::now()); !status) return status.error().message;
      supervisor.poll(5ms);
    }
    return "";
  }
};

TEST_F(ScriptRunnerTest, WaitsInOrder) {
  EXPECT_EQ(run(R"(
    cmd "slow" { exec = "bash -c 'sleep 0.2; echo slow'"; }
    cmd "quick" { exec = "echo quick"; }
    script "s" { start cmd "slow" wait "stopped"; run_script "t"; }
    script "t" { start cmd "quick"; wait cmd "quick" status "stopped"; })"),
            "");
  EXPECT_THAT(lines_, ElementsAre("slow", "quick"));
}

TEST_F(ScriptRunnerTest, AQuickSuccessCountsAsHavingRun) {
  EXPECT_EQ(run("cmd \"c\" { exec = \"true\"; } script \"s\" { start cmd \"c\"; wait ms 100; wait cmd \"c\" status "
                "\"running\"; }"),
            "");
}

TEST_F(ScriptRunnerTest, AWaitHasALimit) {
  EXPECT_EQ(run("cmd \"c\" { exec = \"sleep 1000\"; }\nscript \"s\" { start cmd \"c\" wait \"stopped\"; }", 100ms),
            "test.pmd:2:14: command \"c\" was not stopped after 100 ms");
}

TEST_F(ScriptRunnerTest, AFailedStartEndsTheWait) {
  EXPECT_THAT(run("cmd \"c\" { exec = \"/no/such\"; }\nscript \"s\" { start cmd \"c\" wait \"running\"; }"),
              HasSubstr("ended with an error"));
}

}  // namespace
}  // namespace eg::procman
