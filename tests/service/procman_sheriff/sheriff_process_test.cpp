#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "tests/support/private_network.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

/// The program procman-sheriff with a deputy, as processes over LCM.
namespace eg {
namespace {

using namespace std::chrono_literals;
using test::Program;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr char kUrl[] = "udpm://239.255.76.67:7996?ttl=0";

constexpr char kText[] = R"(
group "g" {
  cmd "ticker" { exec = "bash -c 'while :; do echo tick; sleep 0.2; done'"; host = "localhost"; stop_signal = 15; }
  group "sub" { cmd "oneshot" { exec = "FOO=bar bash -c 'echo $FOO'"; host = "localhost"; } }
}
cmd "failing" { exec = "false"; host = "localhost"; auto_respawn = "true"; }
cmd "far" { exec = "true"; host = "nowhere"; }
script "go" { start cmd "oneshot" wait "stopped"; start group "g"; wait cmd "ticker" status "running";
  wait ms 100; restart cmd "ticker" wait "running"; stop group "g/sub"; }
script "down" { stop cmd "ticker" wait "stopped"; }
script "far" { start cmd "far" wait "running"; }
)";

class SheriffProcess : public testing::Test {
 protected:
  void SetUp() override {
    const std::string why_not = test::enter_private_network(true);
    if (!why_not.empty()) GTEST_SKIP() << why_not;
    file_ = folder_.write("test.pmd", kText).string();
    deputy_.emplace("procman-deputy", std::vector<std::string>{"--name", "localhost", "--lcm-url", kUrl});
  }

  void TearDown() override {
    deputy_.reset();
    EXPECT_TRUE(test::no_process_is_left());
  }

  [[nodiscard]] std::vector<std::string> arguments(std::vector<std::string> more) const {
    more.insert(more.begin(), {"--lcm-url", kUrl, file_});
    return more;
  }

  test::TemporaryFolder folder_;
  std::string file_;
  std::optional<Program> deputy_;
};

TEST_F(SheriffProcess, RunsAScriptAndLeavesTheCommandsToTheDeputy) {
  Program sheriff("procman-sheriff", arguments({"go", "--on-script-complete", "exit"}));
  EXPECT_EQ(sheriff.wait(30s), 0) << sheriff.output();
  EXPECT_THAT(sheriff.output(), AllOf(HasSubstr("[oneshot] bar"), HasSubstr("[ticker] tick"),
                                      HasSubstr("ticker: Restarting"), HasSubstr("script \"go\" is done")));
  Program next("procman-sheriff", arguments({"down", "--on-script-complete", "exit"}));
  EXPECT_EQ(next.wait(30s), 0) << next.output();
  EXPECT_THAT(next.output(), AllOf(HasSubstr("ticker: Running"), HasSubstr("ticker: Stopped (OK)"))) << "taken over";
  EXPECT_THAT(next.output(), Not(HasSubstr("ticker: Starting")));
}

TEST_F(SheriffProcess, ASecondOneGivesWayAndASignalEndsTheFirst) {
  Program first("procman-sheriff", arguments({"go"}));
  ASSERT_TRUE(first.wait_for_output("script \"go\" is done")) << first.output();
  Program second("procman-sheriff", arguments({"down"}));
  EXPECT_EQ(second.wait(30s), 1);
  EXPECT_THAT(second.output(), HasSubstr("error: another sheriff, "));
  first.send_signal(SIGINT);
  EXPECT_EQ(first.wait(30s), 0);
}

TEST_F(SheriffProcess, AWaitForADeputyThatIsNotThereFails) {
  Program sheriff("procman-sheriff", arguments({"far", "--wait-limit", "0.5"}));
  EXPECT_EQ(sheriff.wait(30s), 1);
  EXPECT_THAT(sheriff.output(), HasSubstr("test.pmd:11:16: command \"far\" was not running after 500 ms"));
}

TEST_F(SheriffProcess, ADeputyThatWasKilledGetsItsCommandsBack) {
  Program sheriff("procman-sheriff", arguments({"go"}));
  ASSERT_TRUE(sheriff.wait_for_output("script \"go\" is done")) << sheriff.output();
  deputy_->send_signal(SIGKILL);
  deputy_->wait(30s);
  Program successor("procman-deputy", {"--name", "localhost", "--lcm-url", kUrl});
  EXPECT_TRUE(successor.wait_for_output("ticker started", 10s)) << successor.output();
  EXPECT_THAT(successor.output(), Not(HasSubstr("oneshot started"))) << "it had ended";
}

TEST_F(SheriffProcess, AnUnknownScriptIsRefused) {
  Program sheriff("procman-sheriff", arguments({"nothing"}));
  EXPECT_EQ(sheriff.wait(30s), 1);
  EXPECT_THAT(sheriff.output(), HasSubstr("there is no script \"nothing\""));
}

}  // namespace
}  // namespace eg
