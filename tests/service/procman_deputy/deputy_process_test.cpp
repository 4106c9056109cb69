#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "common/procman/process_tree.hpp"
#include "common/procman/protocol.hpp"
#include "common/transport/lcm_bus.hpp"
#include "tests/support/private_network.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

/// The program procman-deputy, over LCM, with hand-made messages of a sheriff.
namespace eg {
namespace {

using namespace std::chrono_literals;
using procman::Info;
using procman::OrderedCommand;
using procman::Orders;
using test::Program;
using testing::HasSubstr;

constexpr char kUrl[] = "udpm://239.255.76.67:7997?ttl=0";

class DeputyProcess : public testing::Test {
 protected:
  void SetUp() override {
    const std::string why_not = test::enter_private_network(true);
    if (!why_not.empty()) GTEST_SKIP() << why_not;
    auto bus = transport::LcmBus::create({kUrl, ""});
    ASSERT_TRUE(bus) << bus.error().message;
    bus_ = std::move(*bus);
    const auto subscribed = bus_->subscribe(
        procman::channels::kInfo,
        [this](const transport::ReceivedMessage& message) {
          auto info = procman::decode<Info>(message.bytes);
          ASSERT_TRUE(info) << info.error().message;
          info_ = *std::move(info);
        },
        0);
    ASSERT_TRUE(subscribed);
  }

  void TearDown() override { EXPECT_TRUE(test::no_process_is_left()); }

  static std::vector<std::string> arguments(std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"--name", "robot", "--lcm-url", kUrl});
    return more;
  }

  /// Repeats the orders as a sheriff does, until the report fulfils `condition`.
  template <typename Condition>
  bool order_until(const std::vector<OrderedCommand>& commands, Condition condition,
                   std::chrono::milliseconds limit = 15s) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < end) {
      const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
      const std::int64_t utime = std::chrono::duration_cast<std::chrono::microseconds>(since_epoch).count();
      EXPECT_TRUE(
          bus_->publish(procman::channels::kOrders, procman::encode(Orders{utime, "robot", "test:1:1", commands, {}})));
      EXPECT_TRUE(bus_->handle(100ms));
      if (condition()) return true;
    }
    return false;
  }

  static OrderedCommand command(const std::string& exec) {
    OrderedCommand order;
    order.definition = {exec, "c", "", false, SIGINT, 1.0F, {}};
    order.desired_runid = 1;
    order.sheriff_id = 5;
    return order;
  }

  [[nodiscard]] bool runs() const { return !info_.commands.empty() && info_.commands[0].pid > 0; }

  std::unique_ptr<transport::LcmBus> bus_;
  Info info_;
};

// A daemon, an orphan and one that does not listen to the terminal.
constexpr char kClingy[] =
    "bash -c '(setsid sleep 1000 &); (trap \"\" HUP INT; sleep 1000) & trap \"\" HUP; echo up; sleep 1000'";

class DeputyProcessSignals : public DeputyProcess, public testing::WithParamInterface<int> {};

TEST_P(DeputyProcessSignals, StopEverythingAndEndWell) {
  Program deputy("procman-deputy", arguments());
  ASSERT_TRUE(order_until({command(kClingy)}, [&] { return runs(); })) << deputy.output();
  deputy.send_signal(GetParam());
  EXPECT_EQ(deputy.wait(30s), 0);
  EXPECT_TRUE(test::no_process_is_left(0s));
}

INSTANTIATE_TEST_SUITE_P(All, DeputyProcessSignals, testing::Values(SIGINT, SIGTERM));

TEST_F(DeputyProcess, NothingIsLeftOfOneThatIsKilled) {
  Program deputy("procman-deputy", arguments());
  ASSERT_TRUE(order_until({command(kClingy)}, [&] { return runs(); })) << deputy.output();
  deputy.send_signal(SIGKILL);
  EXPECT_EQ(deputy.wait(30s), 128 + SIGKILL);
}

TEST_F(DeputyProcess, NothingIsLeftWhenItsWorkerIsKilled) {
  Program deputy("procman-deputy", arguments());
  ASSERT_TRUE(order_until({command(kClingy)}, [&] { return runs(); })) << deputy.output();
  pid_t parent = 0;  // of the command: the process that does the deputy's work
  for (const procman::Process& process : procman::list_processes()) {
    if (process.pid == info_.commands[0].pid) parent = process.parent;
  }
  ASSERT_GT(parent, 0);
  kill(parent, SIGKILL);
  EXPECT_EQ(deputy.wait(30s), 128 + SIGKILL);
  EXPECT_TRUE(test::no_process_is_left(0s));
}

TEST_F(DeputyProcess, ASecondOneOfTheSameNameGivesWay) {
  Program first("procman-deputy", arguments());
  ASSERT_TRUE(order_until({}, [&] { return info_.host == "robot"; })) << first.output();
  Program second("procman-deputy", arguments());
  EXPECT_EQ(second.wait(30s), 2);
  EXPECT_THAT(second.output(), HasSubstr("a deputy \"robot\" is at work already"));
}

TEST_F(DeputyProcess, RunsWhatALocalFileAllows) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("local.pmd", "cmd \"c\" { exec = \"sleep 1000\"; }");
  Program deputy("procman-deputy", arguments({"--allow-only", file.string()}));
  ASSERT_TRUE(order_until({command("sleep 999")}, [&] {
    return !info_.commands.empty() && info_.commands[0].exit_code == 126 << 8;
  })) << deputy.output();
  OrderedCommand allowed = command("sleep 1000");
  allowed.desired_runid = 2;
  EXPECT_TRUE(order_until({allowed}, [&] { return runs(); }));
}

TEST_F(DeputyProcess, GoesBeyondThisMachineOnlyWhenToldSo) {
  Program deputy("procman-deputy", {"--lcm-url", "udpm://239.255.76.67:7997?ttl=1"});
  EXPECT_EQ(deputy.wait(30s), 1);
  EXPECT_THAT(deputy.output(), HasSubstr("reaches beyond this machine: give --remote"));
}

TEST_F(DeputyProcess, SaysWhatIsWrongWithItsLocalFile) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("local.pmd", "cmd \"c\" { }");
  Program deputy("procman-deputy", arguments({"--allow-only", file.string()}));
  EXPECT_EQ(deputy.wait(30s), 1);
  EXPECT_THAT(deputy.output(), HasSubstr("local.pmd:1:11: command \"c\" has no exec"));
}

}  // namespace
}  // namespace eg
