#include "common/service/service_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "common/messages/channels.hpp"
#include "common/messages/service_state.hpp"
#include "common/transport/memory_bus.hpp"

namespace eg::service {
namespace {

using namespace std::chrono_literals;
using messages::Acknowledge;
using messages::Command;
using messages::Control;
using messages::ControlReply;
using messages::ServiceStatus;
namespace channels = messages::channels;

constexpr std::int64_t kPoison = 13;  ///< the sequence number that the service cannot bear

/// Counts acknowledgements and saves.
class CountingService : public Service {
 public:
  explicit CountingService(ServiceContext& context) {
    context.subscribe<Acknowledge>(channels::kAcknowledge, 0, [this](const Acknowledge& acknowledge) {
      if (acknowledge.sequence == kPoison) throw std::runtime_error("cannot go on");
      ++messages;
    });
  }
  void idle(std::int64_t now_utime) override {
    EXPECT_GE(now_utime, last_idle);
    last_idle = now_utime;
    ++idles;
  }
  base::Status save() override {
    ++saves;
    return save_result;
  }
  [[nodiscard]] bool finished() const override { return messages >= 10; }

  int messages = 0;
  int idles = 0;
  int saves = 0;
  std::int64_t last_idle = 0;
  base::Status save_result;
};

ServiceOptions options() {
  ServiceOptions made;
  made.name = "counter";
  made.out = "/some/folder";
  return made;
}

/// A service in its loop, and somebody else on the same network.
class ServiceLoopTest : public testing::Test {
 protected:
  ServiceLoopTest() {
    peer_.subscribe<ControlReply>(channels::kControlReply, 0,
                                  [this](const ControlReply& reply) { replies_.push_back(reply); });
    peer_.subscribe<ServiceStatus>(channels::kStatus, 0,
                                   [this](const ServiceStatus& status) { statuses_.push_back(status); });
  }

  void step(int times = 1) {
    for (int i = 0; i < times; ++i) ASSERT_TRUE(loop_.step(0ms));
    ASSERT_TRUE(peer_bus_.handle(0ms));
  }
  void send_control(std::int64_t id, Command command, const std::string& service = "") {
    peer_.publish(channels::kControl, Control{id, command, service});
  }
  void send_message(std::int64_t sequence = 0) { peer_.publish(channels::kAcknowledge, Acknowledge{1, sequence, "x"}); }

  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_{network_};
  transport::MemoryBus peer_bus_{network_};
  ServiceContext context_{bus_, options()};
  ServiceContext peer_{peer_bus_, {}};
  CountingService service_{context_};
  ServiceLoop loop_{bus_, context_, service_};
  std::vector<ControlReply> replies_;
  std::vector<ServiceStatus> statuses_;
};

TEST_F(ServiceLoopTest, DeliversMessagesAndCallsIdle) {
  send_message();
  send_message();
  step(3);
  EXPECT_EQ(service_.messages, 2);
  EXPECT_EQ(service_.idles, 3);
  EXPECT_FALSE(loop_.ended());
}

TEST_F(ServiceLoopTest, ReportsItsStatusAtOnceAndThenOnceASecond) {
  step(50);
  ASSERT_EQ(statuses_.size(), 1u);
  EXPECT_EQ(statuses_[0].service, "counter");
}

TEST_F(ServiceLoopTest, SaysThatItHasEnded) {
  step();
  loop_.say_goodbye();
  ASSERT_TRUE(peer_bus_.handle(0ms));
  ASSERT_EQ(statuses_.size(), 2u);
  EXPECT_EQ(statuses_[0].state, "running");
  EXPECT_EQ(statuses_[1].state, messages::kEndedState);
}

TEST_F(ServiceLoopTest, SavesOnRequestAndReplies) {
  send_message();
  send_control(7, Command::save);
  step();
  EXPECT_EQ(service_.saves, 1);
  ASSERT_EQ(replies_.size(), 1u);
  EXPECT_EQ(replies_[0].request_id, 7);
  EXPECT_EQ(replies_[0].service, "counter");
  EXPECT_TRUE(replies_[0].ok);
  EXPECT_FALSE(loop_.ended());
}

TEST_F(ServiceLoopTest, AnswersARepeatedRequestFromMemory) {
  send_message();
  send_control(7, Command::save);
  step();
  send_message();
  send_control(7, Command::save);
  step();
  EXPECT_EQ(service_.saves, 1);
  EXPECT_EQ(replies_.size(), 2u);
}

TEST_F(ServiceLoopTest, SavesAgainOnlyIfSomethingHasComeSince) {
  send_message();
  step();
  EXPECT_TRUE(loop_.save());
  EXPECT_TRUE(loop_.save());
  send_control(1, Command::save);
  step();
  EXPECT_EQ(service_.saves, 1);
  send_message();
  step();
  EXPECT_TRUE(loop_.save());
  EXPECT_EQ(service_.saves, 2);
}

TEST_F(ServiceLoopTest, TellsWhyItCouldNotSave) {
  service_.save_result = base::fail("the disk is full");
  send_control(7, Command::save);
  step();
  ASSERT_EQ(replies_.size(), 1u);
  EXPECT_FALSE(replies_[0].ok);
  EXPECT_EQ(replies_[0].message, "the disk is full");
}

TEST_F(ServiceLoopTest, ShutdownSavesAndEnds) {
  send_control(8, Command::shutdown);
  step();
  EXPECT_EQ(service_.saves, 1);
  EXPECT_TRUE(loop_.ended());
}

TEST_F(ServiceLoopTest, LeavesRequestsToOthersAlone) {
  send_control(8, Command::shutdown, "somebody_else");
  step();
  EXPECT_FALSE(loop_.ended());
  EXPECT_TRUE(replies_.empty());
  send_control(9, Command::shutdown, "counter");
  step();
  EXPECT_TRUE(loop_.ended());
}

TEST_F(ServiceLoopTest, EndsWhenTheServiceIsFinished) {
  for (int i = 0; i < 10; ++i) send_message();
  step();
  EXPECT_TRUE(loop_.ended());
}

TEST_F(ServiceLoopTest, CountsWhatCannotBeDecoded) {
  const std::vector<std::uint8_t> garbage(3, 0xff);
  ASSERT_TRUE(peer_bus_.publish(channels::kAcknowledge, garbage));
  ASSERT_TRUE(peer_bus_.publish(channels::kControl, garbage));
  step();
  const ServiceStatus status = context_.status().status(0);
  EXPECT_EQ(status.rejected, 2);
  EXPECT_THAT(status.last_rejection, testing::StartsWith("CONTROL: "));
  EXPECT_EQ(service_.messages, 0);
}

TEST_F(ServiceLoopTest, AnExceptionOfAHandlerComesOutOfStep) {
  send_message(kPoison);
  EXPECT_THROW(static_cast<void>(loop_.step(0ms)), std::runtime_error);
}

TEST(ServiceLoop, SavesNothingWithoutAFolder) {
  transport::MemoryBus bus(std::make_shared<transport::MemoryNetwork>());
  ServiceContext context(bus, {});
  CountingService service(context);
  ServiceLoop loop(bus, context, service);
  EXPECT_TRUE(loop.save());
  EXPECT_EQ(service.saves, 0);
}

}  // namespace
}  // namespace eg::service
