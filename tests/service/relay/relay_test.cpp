#include "services/relay/relay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/messages/channels.hpp"
#include "common/transport/memory_bus.hpp"

namespace eg::relay {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using transport::MemoryBus;
using transport::MemoryNetwork;
namespace channels = messages::channels;

/// Two networks, with somebody on each.
class RelayTest : public testing::Test {
 protected:
  static std::vector<std::uint8_t> bytes(char value) { return {static_cast<std::uint8_t>(value)}; }

  void note(MemoryBus& bus, const std::string& channel) {
    const auto add = [this, channel](const transport::ReceivedMessage& message) {
      heard_.push_back(channel + static_cast<char>(message.bytes[0]));
    };
    ASSERT_TRUE(bus.subscribe(channel, add, 0));
  }
  void settle() {
    for (int i = 0; i < 5; ++i) {
      ASSERT_TRUE(relay_.step(0ms));
      ASSERT_TRUE(robot_.handle(0ms));
      ASSERT_TRUE(base_.handle(0ms));
    }
  }

  std::shared_ptr<MemoryNetwork> own_network_ = std::make_shared<MemoryNetwork>();
  std::shared_ptr<MemoryNetwork> shared_network_ = std::make_shared<MemoryNetwork>();
  MemoryBus robot_{own_network_};
  MemoryBus base_{shared_network_, "red_"};
  MemoryBus own_{own_network_};
  MemoryBus shared_{shared_network_, "red_"};
  Relay relay_{own_, shared_};
  std::vector<std::string> heard_;
};

TEST_F(RelayTest, PassesWhatIsNamedInItsDirectionOnly) {
  ASSERT_TRUE(relay_.start({{"POSE"}, {"UPDATE"}}));
  for (const char* channel : {"POSE", "UPDATE", "RGBD"}) {
    note(robot_, channel);
    note(base_, channel);
  }
  for (const char* channel : {"POSE", "UPDATE", "RGBD"}) {
    ASSERT_TRUE(robot_.publish(channel, bytes('r')));
    ASSERT_TRUE(base_.publish(channel, bytes('b')));
  }
  settle();
  std::sort(heard_.begin(), heard_.end());
  // Each hears itself; beside that only POSE of the robot and UPDATE of the base have passed.
  EXPECT_THAT(heard_, ElementsAre("POSEb", "POSEr", "POSEr", "RGBDb", "RGBDr", "UPDATEb", "UPDATEb", "UPDATEr"));
  EXPECT_EQ(relay_.traffic().at("POSE").messages, 1);
  EXPECT_EQ(relay_.traffic().at("UPDATE").bytes, 1);
  EXPECT_EQ(relay_.traffic().size(), 2U);
  EXPECT_EQ(relay_.lost(), 0);
}

TEST_F(RelayTest, AChannelThatWouldGoRoundIsRefused) {
  EXPECT_THAT(relay_.start({{"POSE", "STATUS"}, {"STATUS"}}).error().message,
              HasSubstr("channel STATUS is there twice"));
  EXPECT_THAT(relay_.start({{"POSE", "POSE"}, {}}).error().message, HasSubstr("channel POSE is there twice"));
  EXPECT_FALSE(relay_.start({{"NO SUCH"}, {}}));
}

TEST_F(RelayTest, ByDefaultTheGraphPassesAndImagesStay) {
  const Channels passing = default_channels();
  EXPECT_TRUE(validate(passing));
  EXPECT_THAT(passing.out, testing::IsSupersetOf({channels::kKeyframe, channels::kPose, channels::kRestore}));
  EXPECT_THAT(passing.in, testing::IsSupersetOf({channels::kGraphUpdate, channels::kGraphSnapshot}));
  for (const auto& direction : {passing.out, passing.in}) {
    EXPECT_THAT(direction, testing::Not(testing::Contains(channels::kRgbd)));
    EXPECT_THAT(direction, testing::Not(testing::Contains(channels::kFeatures)));
    EXPECT_THAT(direction, testing::Not(testing::Contains(channels::kControl))) << "a run's requests are its own";
  }
}

}  // namespace
}  // namespace eg::relay
