#include "common/transport/lcm_bus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

#include "tests/support/private_network.hpp"
#include "tests/unit/transport/recorder.hpp"

namespace eg::transport {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr milliseconds kLong{2000};
constexpr milliseconds kShort{50};

/// Every test has a network of its own.
void in_private_network(bool with_route, const std::function<void()>& test) {
  const std::string error = test::enter_private_network(with_route);
  if (!error.empty()) GTEST_SKIP() << error;
  test();
}

std::unique_ptr<LcmBus> open_bus(const std::string& prefix = {}) {
  auto bus = LcmBus::create({.url = lcm_url_for_port(7999), .channel_prefix = prefix});
  EXPECT_TRUE(bus) << bus.error().message;
  return bus ? std::move(*bus) : nullptr;
}

/// Handles until `count` messages have come, or none comes any more.
void handle_until(Bus& bus, const std::vector<std::string>& messages, std::size_t count) {
  while (messages.size() < count) {
    const auto handled = bus.handle(kLong);
    ASSERT_TRUE(handled) << handled.error().message;
    if (*handled == 0) return;
  }
}

TEST(LcmBus, DeliversInTheOrderOfSending) {
  in_private_network(true, [] {
    const auto sender = open_bus();
    const auto receiver = open_bus();
    ASSERT_TRUE(sender && receiver);
    Recorder recorder;
    ASSERT_TRUE(receiver->subscribe("A", recorder.handler(), 0));
    std::vector<std::string> sent;
    for (int i = 0; i < 100; ++i) {
      sent.push_back(std::to_string(i));
      ASSERT_TRUE(sender->publish("A", bytes_of(sent.back())));
    }
    handle_until(*receiver, recorder.texts, 100);
    EXPECT_EQ(recorder.texts, sent);
    EXPECT_GT(recorder.utimes.front(), 0);
  });
}

TEST(LcmBus, CarriesMessagesOfAFramesSize) {
  in_private_network(true, [] {
    const auto bus = open_bus();
    ASSERT_TRUE(bus);
    Recorder recorder;
    ASSERT_TRUE(bus->subscribe("A", recorder.handler(), 0));
    std::string large(180'000, ' ');
    for (std::size_t i = 0; i < large.size(); ++i) large[i] = static_cast<char>(i % 251);
    ASSERT_TRUE(bus->publish("A", bytes_of(large)));
    handle_until(*bus, recorder.texts, 1);
    EXPECT_THAT(recorder.texts, ElementsAre(large));
  });
}

TEST(LcmBus, HearsOnlyItsPrefix) {
  in_private_network(true, [] {
    const auto one = open_bus("EG.1_");
    const auto two = open_bus("EGx1_");
    ASSERT_TRUE(one && two);
    Recorder recorder;
    ASSERT_TRUE(one->subscribe("POSE", recorder.handler(), 0));
    ASSERT_TRUE(two->publish("POSE", bytes_of("two")));
    ASSERT_TRUE(one->publish("POSES", bytes_of("other channel")));
    ASSERT_TRUE(one->publish("POSE", bytes_of("one")));
    handle_until(*one, recorder.texts, 1);
    EXPECT_EQ(one->handle(kShort).value(), 0);
    EXPECT_THAT(recorder.channels, ElementsAre("POSE"));
    EXPECT_THAT(recorder.texts, ElementsAre("one"));
  });
}

TEST(LcmBus, KeepsPortsApart) {
  in_private_network(true, [] {
    const auto here = open_bus();
    const auto there = LcmBus::create({.url = lcm_url_for_port(7998), .channel_prefix = {}});
    ASSERT_TRUE(here && there);
    Recorder recorder;
    ASSERT_TRUE(here->subscribe("A", recorder.handler(), 0));
    ASSERT_TRUE((*there)->publish("A", bytes_of("x")));
    EXPECT_EQ(here->handle(kShort).value(), 0);
  });
}

TEST(LcmBus, DropsNewMessagesWhenTheQueueIsFull) {
  in_private_network(true, [] {
    const auto bus = open_bus();
    ASSERT_TRUE(bus);
    Recorder bounded, all;
    ASSERT_TRUE(bus->subscribe("A", bounded.handler(), 3));
    ASSERT_TRUE(bus->subscribe("A", all.handler(), 0));
    for (const char* text : {"1", "2", "3", "4", "5"}) ASSERT_TRUE(bus->publish("A", bytes_of(text)));
    std::this_thread::sleep_for(milliseconds(200));  // LCM's own thread receives
    handle_until(*bus, all.texts, 5);
    EXPECT_THAT(all.texts, ElementsAre("1", "2", "3", "4", "5"));
    EXPECT_THAT(bounded.texts, ElementsAre("1", "2", "3"));
  });
}

TEST(LcmBus, CarriesExceptionsOutAndGoesOn) {
  in_private_network(true, [] {
    const auto bus = open_bus();
    ASSERT_TRUE(bus);
    Recorder recorder;
    ASSERT_TRUE(bus->subscribe(
        "BAD", [](const ReceivedMessage&) { throw std::runtime_error("from a handler"); }, 0));
    ASSERT_TRUE(bus->subscribe("GOOD", recorder.handler(), 0));
    ASSERT_TRUE(bus->publish("BAD", {}));
    EXPECT_THROW((void)bus->handle(kLong), std::runtime_error);
    ASSERT_TRUE(bus->publish("GOOD", bytes_of("x")));
    handle_until(*bus, recorder.texts, 1);
    EXPECT_EQ(recorder.texts.size(), 1U);
  });
}

TEST(LcmBus, ReturnsInTimeWhenNothingComes) {
  in_private_network(true, [] {
    const auto bus = open_bus();
    ASSERT_TRUE(bus);
    ASSERT_TRUE(bus->subscribe(
        "A", [](const ReceivedMessage&) {}, 0));
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(bus->handle(kShort).value(), 0);
    EXPECT_LT(std::chrono::steady_clock::now() - start, kLong);
  });
}

TEST(LcmBus, RefusesWhatCannotBeSent) {
  in_private_network(true, [] {
    const auto bus = open_bus("EG_");
    ASSERT_TRUE(bus);
    EXPECT_FALSE(bus->publish(std::string(64, 'A'), {}));
    EXPECT_FALSE(bus->publish("A.*", {}));
    EXPECT_FALSE(bus->subscribe(
        "A.*", [](const ReceivedMessage&) {}, 0));
    EXPECT_FALSE(bus->publish("A", std::vector<std::uint8_t>(40 << 20)));
  });
}

TEST(LcmBus, SaysHowToMendAMissingRoute) {
  in_private_network(false, [] {
    const auto bus = LcmBus::create({.url = kDefaultLcmUrl, .channel_prefix = {}});
    ASSERT_FALSE(bus);
    EXPECT_THAT(bus.error().message, HasSubstr("`ip link set lo up; ip route add 224.0.0.0/4 dev lo`"));
  });
}

TEST(LcmBus, SaysThatAUrlIsWrong) {
  const auto bus = LcmBus::create({.url = "carrier-pigeon://", .channel_prefix = {}});
  ASSERT_FALSE(bus);
  EXPECT_THAT(bus.error().message, HasSubstr("carrier-pigeon://"));
}

}  // namespace
}  // namespace eg::transport
