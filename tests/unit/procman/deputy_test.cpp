#include "common/procman/deputy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "common/procman/process_tree.hpp"

namespace eg::procman {
namespace {

using namespace std::chrono_literals;
using testing::Each;
using testing::Gt;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Le;
using testing::SizeIs;

constexpr std::int64_t kStart = 1'700'000'000'000'000;
constexpr char kTicker[] = "bash -c 'while :; do sleep 0.02; done'";

/// A deputy called "robot" that hears what the test says. Its clock is the real one, so far ahead as the test wants.
class DeputyTest : public testing::Test {
 protected:
  Deputy& make(std::optional<Configuration> allowed = std::nullopt) {
    deputy_.emplace(Deputy::Options{"robot", 17, std::move(allowed)},
                    DeputyOutbox{[this](const Info& info) { infos_.push_back(info); },
                                 [this](const Printf& text) { texts_.push_back(text); },
                                 [this](const Discovery& discovery) { discoveries_.push_back(discovery); }},
                    now());
    return *deputy_;
  }

  /// One that has found no other of its name.
  Deputy& make_ready(std::optional<Configuration> allowed = std::nullopt) {
    make(std::move(allowed));
    ahead_ += 2s;
    return *deputy_;
  }

  [[nodiscard]] Now now() const {
    const Clock::time_point time = Clock::now() + ahead_;
    return {time, kStart + std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count()};
  }

  static OrderedCommand command(std::int32_t id, const std::string& exec, std::int32_t runid = 1) {
    OrderedCommand order;
    order.definition = {exec, std::string("c").append(std::to_string(id)), "outer/inner", false, SIGINT, 1.0F, {}};
    order.desired_runid = runid;
    order.sheriff_id = id;
    return order;
  }

  void order(std::vector<OrderedCommand> commands, const std::string& sheriff = "sheriff:1:1") {
    deputy_->handle(Orders{now().utime, "robot", sheriff, std::move(commands), {}}, now());
    step();
  }

  void step() { deputy_->step(now(), 0ms); }

  template <typename Condition>
  bool step_until(Condition condition, std::chrono::milliseconds limit = 5s) {
    const auto end = Clock::now() + limit;
    while (!condition() && Clock::now() < end) deputy_->step(now(), 5ms);
    return condition();
  }

  /// The latest report on a command; one with sheriff_id 0 if it is not listed.
  [[nodiscard]] ReportedCommand reported(std::int32_t id) const {
    if (infos_.empty()) return {};
    for (const ReportedCommand& entry : infos_.back().commands) {
      if (entry.sheriff_id == id) return entry;
    }
    return {};
  }

  [[nodiscard]] bool runs(std::int32_t id) const { return reported(id).pid > 0; }
  [[nodiscard]] bool has_ended(std::int32_t id) const {
    return reported(id).sheriff_id == id && reported(id).pid == 0 && reported(id).actual_runid > 0;
  }

  [[nodiscard]] std::string output(std::int32_t id) const {
    std::string all;
    for (const Printf& text : texts_) {
      if (text.sheriff_id == id) all += text.text;
    }
    return all;
  }

  void TearDown() override {
    deputy_.reset();
    EXPECT_THAT(find_descendants(getpid()), IsEmpty());
  }

  std::optional<Deputy> deputy_;
  std::chrono::milliseconds ahead_{0};
  std::vector<Info> infos_;
  std::vector<Printf> texts_;
  std::vector<Discovery> discoveries_;
};

TEST_F(DeputyTest, FirstAsksFiveTimesASecondWhetherItsNameIsTaken) {
  make();
  for (int i = 0; i < 30; ++i) {
    step();
    ahead_ += 100ms;
  }
  EXPECT_THAT(discoveries_, SizeIs(testing::AllOf(testing::Ge(7U), Le(8U))));
  EXPECT_THAT(discoveries_, Each(testing::Field(&Discovery::nonce, 17)));
  EXPECT_THAT(discoveries_, Each(testing::Field(&Discovery::host, "robot")));
  EXPECT_FALSE(deputy_->conflict());
  EXPECT_THAT(infos_, SizeIs(Gt(0U)));
}

TEST_F(DeputyTest, GivesWayToADeputyOfItsNameAtWork) {
  make().handle(Info{1, "robot", 0, 0, 0, 0, 0, {}, {}}, now());
  ASSERT_TRUE(deputy_->conflict());
  EXPECT_EQ(deputy_->conflict()->exit_code, 2);
}

TEST_F(DeputyTest, GivesWayToADeputyOfItsNameThatStartsToo) {
  make().handle(Discovery{1, "robot", 18}, now());
  ASSERT_TRUE(deputy_->conflict());
  EXPECT_EQ(deputy_->conflict()->exit_code, 1);
}

TEST_F(DeputyTest, IsAloneWithItselfAndWithOthers) {
  Deputy& deputy = make();
  deputy.handle(Discovery{1, "robot", 17}, now());
  deputy.handle(Discovery{1, "other", 18}, now());
  deputy.handle(Discovery{1, "", 0}, now());
  deputy.handle(Info{1, "other", 0, 0, 0, 0, 0, {}, {}}, now());
  EXPECT_FALSE(deputy.conflict());
  EXPECT_THAT(infos_, IsEmpty());
  ahead_ += 2s;
  deputy.handle(Info{1, "robot", 0, 0, 0, 0, 0, {}, {}}, now());
  EXPECT_FALSE(deputy.conflict());
  deputy.handle(Discovery{1, "", 0}, now());
  EXPECT_THAT(infos_, SizeIs(1));
}

TEST_F(DeputyTest, IgnoresOrdersUntilItKnowsThatItIsAlone) {
  make();
  order({command(1, kTicker)});
  ahead_ += 2s;
  step();
  EXPECT_THAT(infos_.back().commands, IsEmpty());
}

TEST_F(DeputyTest, StartsWhatIsOrderedAndReportsIt) {
  make_ready();
  order({command(7, "bash -c 'echo up; sleep 1000'", 5)});
  ASSERT_TRUE(step_until([&] { return runs(7) && output(7) == "up\n"; }));
  const ReportedCommand report = reported(7);
  EXPECT_EQ(report.definition, command(7, "bash -c 'echo up; sleep 1000'").definition);
  EXPECT_EQ(report.actual_runid, 5);
  EXPECT_EQ(report.exit_code, 0);
  EXPECT_EQ(infos_.back().host, "robot");
  EXPECT_GT(infos_.back().memory_total_bytes, 0);
  EXPECT_EQ(kill(report.pid, 0), 0);
}

TEST_F(DeputyTest, ReportsOncePerSecondAndOnEveryChange) {
  make_ready();
  order({command(1, kTicker)});
  ASSERT_TRUE(step_until([&] { return runs(1); }));
  step_until([] { return false; }, 100ms);
  const std::size_t before = infos_.size();
  step_until([] { return false; }, 100ms);
  EXPECT_LE(infos_.size(), before + 1);
  ahead_ += 1s;
  step();
  EXPECT_EQ(infos_.size(), before + 1);
  EXPECT_GT(reported(1).resident_bytes, 0);
}

TEST_F(DeputyTest, ExitCodesAreRawWaitStatus) {
  make_ready();
  order({command(1, "bash -c 'exit 3'"), command(2, "sleep 1000"), command(3, "/no/such/program"), command(4, "true")});
  ASSERT_TRUE(step_until([&] { return has_ended(1) && has_ended(3) && has_ended(4) && runs(2); }));
  EXPECT_EQ(reported(1).exit_code, 768);
  EXPECT_EQ(reported(3).exit_code, 127 << 8);
  EXPECT_EQ(reported(4).exit_code, 0);
  OrderedCommand quit = command(2, "sleep 1000");
  quit.force_quit = true;
  order({quit});
  ASSERT_TRUE(step_until([&] { return has_ended(2); }));
  EXPECT_EQ(reported(2).exit_code, SIGINT);
}

TEST_F(DeputyTest, WhatHasEndedStaysSoUntilTheRunIdChanges) {
  make_ready();
  for (int repeat = 0; repeat < 5; ++repeat) {
    order({command(1, "echo once")});
    step_until([] { return false; }, 30ms);
  }
  EXPECT_EQ(output(1), "once\n");
  order({command(1, "echo once", 2)});
  EXPECT_TRUE(step_until([&] { return output(1) == "once\nonce\n"; }));
  EXPECT_TRUE(step_until([&] { return reported(1).actual_runid == 2; }));
}

TEST_F(DeputyTest, ANewRunIdRestartsWhatRunsWithoutFurtherOrders) {
  make_ready();
  order({command(1, kTicker, 1)});
  ASSERT_TRUE(step_until([&] { return runs(1); }));
  const int pid = reported(1).pid;
  order({command(1, kTicker, 2)});
  ASSERT_TRUE(step_until([&] { return runs(1) && reported(1).pid != pid; }));
  EXPECT_EQ(reported(1).actual_runid, 2);
}

TEST_F(DeputyTest, WhatIsNotListedIsStoppedAndForgotten) {
  make_ready();
  order({command(1, kTicker), command(2, kTicker)});
  ASSERT_TRUE(step_until([&] { return runs(1) && runs(2); }));
  order({command(2, kTicker)});
  EXPECT_TRUE(step_until([&] { return reported(1).sheriff_id == 0; }));
  EXPECT_TRUE(runs(2));
  EXPECT_THAT(infos_.back().commands, SizeIs(1));
}

TEST_F(DeputyTest, OrdersForAnotherHostAndOldOnesAreIgnored) {
  Deputy& deputy = make_ready();
  const std::vector<OrderedCommand> commands = {command(1, kTicker)};
  const auto at = now();
  deputy.handle(Orders{at.utime, "other", "s", commands, {}}, at);
  deputy.handle(Orders{at.utime - 60'000'001, "robot", "s", commands, {}}, at);
  deputy.handle(Orders{INT64_MIN, "robot", "s", commands, {}}, at);
  step();
  EXPECT_THAT(infos_.back().commands, IsEmpty());
  deputy.handle(Orders{at.utime - 59'000'000, "robot", "s", commands, {}}, at);
  step();
  EXPECT_THAT(infos_.back().commands, SizeIs(1));
}

TEST_F(DeputyTest, AThousandStartsAndStopsInARow) {
  make_ready();
  order({command(2, kTicker)});
  for (int runid = 1; runid <= 1000; ++runid) {
    OrderedCommand wanted = command(1, "sleep 1000", runid);
    order({wanted, command(2, kTicker)});
    wanted.force_quit = true;
    order({wanted, command(2, kTicker)});
  }
  ASSERT_TRUE(step_until([&] { return has_ended(1) && reported(1).actual_runid == 1000; }));
  EXPECT_TRUE(runs(2));
  order({command(1, "sleep 1000", 1001), command(2, kTicker)});
  EXPECT_TRUE(step_until([&] { return runs(1) && reported(1).actual_runid == 1001; }));
}

TEST_F(DeputyTest, KillsInTimeThoughNoMoreOrdersCome) {
  make_ready();
  const std::string stubborn = "bash -c 'trap \"\" INT; echo up; while :; do sleep 0.02; done'";
  order({command(1, stubborn)});
  ASSERT_TRUE(step_until([&] { return output(1) == "up\n"; }));
  order({});
  EXPECT_TRUE(step_until([&] { return reported(1).sheriff_id == 0; }, 4s));
}

TEST_F(DeputyTest, RespawnsWhatIsToRespawn) {
  make_ready();
  OrderedCommand wanted = command(1, "bash -c 'echo up; exit 1'");
  wanted.definition.auto_respawn = true;
  order({wanted});
  EXPECT_TRUE(step_until([&] { return output(1).size() >= 9; }));
  EXPECT_EQ(reported(1).actual_runid, 1);
  wanted.force_quit = true;
  order({wanted});
  const std::size_t size = output(1).size();
  step_until([] { return false; }, 200ms);
  EXPECT_EQ(output(1).size(), size);
}

TEST_F(DeputyTest, ANewDefinitionHoldsFromTheNextStart) {
  make_ready();
  order({command(1, "bash -c 'echo old; sleep 1000'")});
  ASSERT_TRUE(step_until([&] { return output(1) == "old\n"; }));
  order({command(1, "bash -c 'echo new; sleep 1000'", 1)});
  step_until([] { return false; }, 50ms);
  EXPECT_EQ(output(1), "old\n");
  order({command(1, "bash -c 'echo new; sleep 1000'", 2)});
  EXPECT_TRUE(step_until([&] { return output(1) == "old\nnew\n"; }));
}

TEST_F(DeputyTest, OutputComesInPiecesThatEveryProcmanTakes) {
  make_ready();
  order({command(1, "bash -c 'head -c 100000 /dev/zero | tr \"\\\\0\" x; echo; sleep 1000'")});
  ASSERT_TRUE(step_until([&] { return output(1).size() == 100001; }));
  for (const Printf& text : texts_) EXPECT_LE(text.text.size(), 1023U);
}

TEST_F(DeputyTest, OutputWithoutEndIsCutAndTheOthersGoOn) {
  make_ready();
  order({command(1, "yes"), command(2, "bash -c 'sleep 0.1; echo heard; sleep 1000'")});
  EXPECT_TRUE(step_until([&] { return output(2) == "heard\n"; }));
  EXPECT_LE(output(1).size(), 256U << 10U);  // of two seconds at most
  ahead_ += 1s;
  step();
  EXPECT_THAT(output(1), HasSubstr("bytes of output were left out"));
}

TEST_F(DeputyTest, RunsAllowedCommandsOnly) {
  make_ready(parse_configuration("cmd \"c1\" { exec = \"sleep 1000\"; }", "local.pmd").value());
  order({command(1, "sleep 1000"), command(2, "sleep 1000")});
  ASSERT_TRUE(step_until([&] { return runs(1) && has_ended(2); }));
  EXPECT_EQ(reported(2).exit_code, 126 << 8);
  EXPECT_THAT(output(0), HasSubstr("c2 is not among the commands that this deputy may run"));
  order({command(1, "sleep 999", 2)});
  ASSERT_TRUE(step_until([&] { return has_ended(1); }));
  EXPECT_EQ(reported(1).exit_code, 126 << 8);
}

TEST_F(DeputyTest, SaysThatTwoSheriffsAreAtWork) {
  make_ready();
  order({}, "a:1:1");
  order({}, "a:1:1");
  EXPECT_EQ(output(0), "");
  order({}, "b:2:2");
  EXPECT_EQ(output(0), "") << "the first may have ended";
  order({}, "a:1:1");
  EXPECT_THAT(output(0), HasSubstr("two sheriffs are at work, b:2:2 and a:1:1"));
  texts_.clear();
  ahead_ += 10s;
  order({}, "a:1:1");
  EXPECT_EQ(output(0), "");
}

TEST_F(DeputyTest, ShutsDownWithAllItsCommands) {
  Deputy& deputy = make_ready();
  order({command(1, kTicker), command(2, "bash -c '(setsid sleep 1000 &); sleep 1000'")});
  ASSERT_TRUE(step_until([&] { return runs(1) && runs(2); }));
  deputy.shut_down();
  EXPECT_TRUE(step_until([&] { return !deputy.busy(); }));
  order({command(1, kTicker, 2)});
  EXPECT_FALSE(deputy.busy());
}

}  // namespace
}  // namespace eg::procman
