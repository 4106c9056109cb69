#include "common/procman/sheriff.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/procman/script_runner.hpp"

namespace eg::procman {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr char kText[] = R"(
group "g" {
  cmd "a" { exec = "A"; host = "robot"; }
  group "sub" { cmd "b" { exec = "B"; host = "robot"; stop_signal = 15; } }
}
cmd "c" { exec = "C"; }
script "go" { start group "g" wait "running"; run_script "then"; }
script "then" { stop group "g/sub" wait "stopped"; }
)";
constexpr std::size_t kA = 0;
constexpr std::size_t kB = 1;
constexpr std::size_t kC = 2;

/// A sheriff and deputies that do what it says, as long as they are asked to.
class SheriffTest : public testing::Test {
 protected:
  SheriffTest() : configuration_(parse_configuration(kText, "test.pmd").value()) {}

  Sheriff& make() {
    sheriff_.emplace(configuration_, Sheriff::Options{"here:17:1000", 1}, now_);
    return *sheriff_;
  }

  void pass(std::chrono::milliseconds time) {
    now_.time += time;
    now_.utime += std::chrono::duration_cast<std::chrono::microseconds>(time).count();
  }

  Info& deputy(const std::string& host) {
    Info& info = deputies_[host];
    info.host = host;
    return info;
  }

  void report(const std::string& host) {
    deputy(host).utime = now_.utime;
    sheriff_->handle(deputy(host), now_);
  }

  /// Takes the orders that are due, has the deputies carry them out and report.
  std::vector<Orders> obey() {
    const std::vector<Orders> all = sheriff_->take_orders(now_);
    for (const Orders& orders : all) {
      Info& info = deputy(orders.host);
      const std::vector<ReportedCommand> before = std::exchange(info.commands, {});
      for (const OrderedCommand& order : orders.commands) info.commands.push_back(carry_out(order, before));
      report(orders.host);
    }
    return all;
  }

  ReportedCommand carry_out(const OrderedCommand& order, const std::vector<ReportedCommand>& before) {
    ReportedCommand command;
    command.sheriff_id = order.sheriff_id;
    for (const ReportedCommand& known : before) {
      if (known.sheriff_id == order.sheriff_id) command = known;
    }
    command.definition = order.definition;
    if (order.force_quit && command.pid > 0) {
      command.pid = 0;
      command.exit_code = order.definition.stop_signal;
    } else if (!order.force_quit && command.actual_runid != order.desired_runid) {
      command.pid = ++last_pid_;
      command.exit_code = 0;
    }
    command.actual_runid = order.desired_runid;
    return command;
  }

  [[nodiscard]] CommandStatus status(std::size_t command) const { return sheriff_->status(command, now_); }

  ReportedCommand& reported(const std::string& host, std::size_t index) { return deputy(host).commands.at(index); }

  Configuration configuration_;
  std::optional<Sheriff> sheriff_;
  Now now_{Clock::now(), 1'700'000'000'000'000};
  std::map<std::string, Info> deputies_;
  int last_pid_ = 100;
};

TEST_F(SheriffTest, OrdersOnlyDeputiesItHasHeardOfAndKnows) {
  make();
  pass(2s);
  EXPECT_THAT(obey(), IsEmpty());
  report("robot");
  report("stranger");
  const auto orders = obey();
  ASSERT_THAT(orders, SizeIs(1));
  EXPECT_EQ(orders[0].host, "robot");
  EXPECT_EQ(orders[0].sheriff_name, "here:17:1000");
  EXPECT_EQ(orders[0].utime, now_.utime);
  ASSERT_THAT(orders[0].commands, SizeIs(2));
  EXPECT_EQ(orders[0].commands[1].definition, (CommandDefinition{"B", "b", "g/sub", false, 15, 7.0F, {}}));
  EXPECT_EQ(orders[0].commands[1].desired_runid, 0);
  EXPECT_GT(orders[0].commands[1].sheriff_id, 0);
  EXPECT_NE(orders[0].commands[0].sheriff_id, orders[0].commands[1].sheriff_id);
}

TEST_F(SheriffTest, ACommandWithoutHostIsLocalhosts) {
  make();
  pass(2s);
  report("localhost");
  const auto orders = obey();
  ASSERT_THAT(orders, SizeIs(1));
  EXPECT_EQ(orders[0].commands[0].definition.name, "c");
}

TEST_F(SheriffTest, RepeatsItselfAtOneHertzAndOnChanges) {
  make();
  report("robot");
  EXPECT_THAT(obey(), IsEmpty()) << "it listens first";
  pass(1200ms);
  EXPECT_THAT(obey(), SizeIs(1));
  pass(900ms);
  EXPECT_THAT(obey(), IsEmpty());
  pass(100ms);
  EXPECT_THAT(obey(), SizeIs(1));
  sheriff_->start(kA);
  EXPECT_THAT(obey(), SizeIs(1));
  sheriff_->start(kA);
  EXPECT_THAT(obey(), IsEmpty()) << "it runs already";
}

TEST_F(SheriffTest, StatusGoesThroughLibbot2sWords) {
  make();
  EXPECT_EQ(status(kA), CommandStatus::unknown);
  sheriff_->start(kA);
  report("robot");
  EXPECT_EQ(status(kA), CommandStatus::starting);
  pass(2s);
  obey();
  EXPECT_EQ(status(kA), CommandStatus::running);
  EXPECT_EQ(status(kB), CommandStatus::stopped_ok);
  EXPECT_EQ(sheriff_->condition(kB), Condition::not_started);
  sheriff_->restart(kA);
  EXPECT_EQ(status(kA), CommandStatus::restarting);
  obey();
  EXPECT_EQ(status(kA), CommandStatus::running);
  sheriff_->stop(kA);
  EXPECT_EQ(status(kA), CommandStatus::stopping);
  obey();
  EXPECT_EQ(status(kA), CommandStatus::stopped_ok);
  sheriff_->start(kA);
  obey();
  reported("robot", 0).pid = 0;
  reported("robot", 0).exit_code = 768;
  report("robot");
  EXPECT_EQ(status(kA), CommandStatus::stopped_error);
  pass(31s);
  EXPECT_EQ(status(kA), CommandStatus::unknown);
  EXPECT_STREQ(to_string(CommandStatus::stopped_error), "Stopped (Error)");
  EXPECT_STREQ(to_string(CommandStatus::stopped_ok), "Stopped (OK)");
}

TEST_F(SheriffTest, TakesOverWhatRunsAlready) {
  ReportedCommand running;
  running.definition = to_definition(configuration_.commands[kA]);
  running.sheriff_id = 4711;
  running.pid = 99;
  running.actual_runid = 5;
  ReportedCommand other = running;
  other.definition.exec = "an older A";
  other.sheriff_id = 4712;
  deputy("robot").commands = {other, running};
  make();
  sheriff_->start(kA);
  report("robot");
  pass(2s);
  const auto orders = obey();
  ASSERT_THAT(orders, SizeIs(1));
  EXPECT_EQ(orders[0].commands[0].sheriff_id, 4711);
  EXPECT_EQ(orders[0].commands[0].desired_runid, 5);
  EXPECT_EQ(status(kA), CommandStatus::running);
  EXPECT_EQ(sheriff_->report(kA)->pid, 99);
  EXPECT_THAT(orders[0].commands, SizeIs(2)) << "what the configuration does not define is left out, and so ends";
}

TEST_F(SheriffTest, CountsOnFromAnyRunThatADeputyNames) {
  ReportedCommand running;
  running.definition = to_definition(configuration_.commands[kA]);
  running.sheriff_id = 4711;
  running.pid = 99;
  running.actual_runid = INT32_MAX;
  deputy("robot").commands = {running};
  make();
  report("robot");
  pass(2s);
  sheriff_->restart(kA);
  EXPECT_EQ(status(kA), CommandStatus::restarting);
  obey();
  EXPECT_EQ(status(kA), CommandStatus::running);
}

TEST_F(SheriffTest, RemembersSomeStrangersAndEveryDeputyOfItsOwn) {
  make();
  for (int i = 0; i < 1000; ++i) report("stranger " + std::to_string(i));
  EXPECT_THAT(sheriff_->deputies(), SizeIs(256));
  report("robot");
  report("stranger 1");
  EXPECT_TRUE(sheriff_->deputies().contains("robot"));
  pass(2s);
  EXPECT_THAT(obey(), SizeIs(1));
}

TEST_F(SheriffTest, WhatWasStartedBeforeItsDeputyWasHeardOfIsStartedThen) {
  make();
  sheriff_->start(kC);
  pass(2s);
  report("localhost");
  obey();
  EXPECT_EQ(status(kC), CommandStatus::running);
}

TEST_F(SheriffTest, ADeputyThatWasStartedAnewStartsWhatRanAndNothingElse) {
  make();
  report("robot");
  pass(2s);
  sheriff_->start(kA);
  sheriff_->start(kB);
  obey();
  reported("robot", 1).pid = 0;  // b ends by itself
  report("robot");
  deputy("robot").commands.clear();
  report("robot");
  pass(1s);
  obey();
  EXPECT_EQ(status(kA), CommandStatus::running);
  EXPECT_EQ(sheriff_->report(kB)->pid, 0);
}

TEST_F(SheriffTest, GivesWayToASheriffThatIsThere) {
  make();
  sheriff_->handle(Orders{now_.utime, "elsewhere", "other:1:1", {}, {}}, now_);
  sheriff_->handle(Orders{now_.utime, "robot", "here:17:1000", {}, {}}, now_);
  EXPECT_EQ(sheriff_->superior(), "");
  sheriff_->handle(Orders{now_.utime, "robot", "other:1:2000", {}, {}}, now_);
  EXPECT_EQ(sheriff_->superior(), "other:1:2000");
}

TEST_F(SheriffTest, OfTwoAtWorkTheYoungerGivesWay) {
  make();
  pass(5s);
  sheriff_->handle(Orders{now_.utime, "robot", "other:1:2000", {}, {}}, now_);
  EXPECT_EQ(sheriff_->superior(), "");
  EXPECT_EQ(sheriff_->intruder(), "other:1:2000");
  sheriff_->handle(Orders{now_.utime, "robot", "other:1:999", {}, {}}, now_);
  EXPECT_EQ(sheriff_->superior(), "other:1:999");
}

TEST_F(SheriffTest, CarriesAScriptOut) {
  make();
  ScriptRunner script(configuration_, *sheriff_, "go", {10s});
  ASSERT_TRUE(script.step(now_.time));
  pass(2s);
  report("robot");
  for (int i = 0; i < 5 && !script.done(); ++i) {
    obey();
    ASSERT_TRUE(script.step(now_.time));
  }
  EXPECT_TRUE(script.done());
  EXPECT_EQ(status(kA), CommandStatus::running);
  EXPECT_EQ(status(kB), CommandStatus::stopped_ok);
}

TEST_F(SheriffTest, AScriptDoesNotWaitForeverForADeputy) {
  make();
  ScriptRunner script(configuration_, *sheriff_, "go", {10s});
  ASSERT_TRUE(script.step(now_.time));
  pass(11s);
  const auto status = script.step(now_.time);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("test.pmd:7:15: command \"a\" was not running after 10000 ms"));
}

}  // namespace
}  // namespace eg::procman
