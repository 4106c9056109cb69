#include "common/transport/memory_bus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "tests/unit/transport/recorder.hpp"

namespace eg::transport {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

TEST(MemoryBus, DeliversInTheOrderOfSending) {
  const auto network = std::make_shared<MemoryNetwork>();
  MemoryBus sender(network), receiver(network);
  Recorder recorder;
  ASSERT_TRUE(receiver.subscribe("A", recorder.handler(), 0));
  ASSERT_TRUE(receiver.subscribe("B", recorder.handler(), 0));
  network->set_time(42);
  for (const char* text : {"1", "2", "3"}) {
    ASSERT_TRUE(sender.publish("A", bytes_of(text)));
    ASSERT_TRUE(sender.publish("B", bytes_of(text)));
  }
  EXPECT_EQ(receiver.handle(milliseconds(0)).value(), 6);
  EXPECT_THAT(recorder.texts, ElementsAre("1", "1", "2", "2", "3", "3"));
  EXPECT_THAT(recorder.channels, ElementsAre("A", "B", "A", "B", "A", "B"));
  EXPECT_EQ(recorder.utimes.front(), 42);
  EXPECT_EQ(receiver.handle(milliseconds(0)).value(), 0);
}

TEST(MemoryBus, HearsItsOwnMessagesLikeLcm) {
  const auto network = std::make_shared<MemoryNetwork>();
  MemoryBus bus(network);
  Recorder recorder;
  ASSERT_TRUE(bus.subscribe("A", recorder.handler(), 0));
  ASSERT_TRUE(bus.publish("A", bytes_of("echo")));
  EXPECT_EQ(bus.handle(milliseconds(0)).value(), 1);
}

TEST(MemoryBus, HearsOnlyItsPrefix) {
  const auto network = std::make_shared<MemoryNetwork>();
  MemoryBus one(network, "EG1_"), two(network, "EG2_"), plain(network);
  Recorder heard_by_one, heard_by_two, heard_by_plain;
  ASSERT_TRUE(one.subscribe("POSE", heard_by_one.handler(), 0));
  ASSERT_TRUE(two.subscribe("POSE", heard_by_two.handler(), 0));
  ASSERT_TRUE(plain.subscribe("EG1_POSE", heard_by_plain.handler(), 0));
  ASSERT_TRUE(one.publish("POSE", bytes_of("x")));
  for (MemoryBus* bus : {&one, &two, &plain}) ASSERT_TRUE(bus->handle(milliseconds(0)));
  EXPECT_THAT(heard_by_one.channels, ElementsAre("POSE"));
  EXPECT_TRUE(heard_by_two.channels.empty());
  EXPECT_THAT(heard_by_plain.channels, ElementsAre("EG1_POSE"));
}

TEST(MemoryBus, DropsNewMessagesWhenTheQueueIsFull) {
  const auto network = std::make_shared<MemoryNetwork>();
  MemoryBus bus(network);
  Recorder small, unbounded;
  ASSERT_TRUE(bus.subscribe("A", small.handler(), 2));
  ASSERT_TRUE(bus.subscribe("A", unbounded.handler(), 0));
  for (const char* text : {"1", "2", "3"}) ASSERT_TRUE(bus.publish("A", bytes_of(text)));
  EXPECT_EQ(bus.handle(milliseconds(0)).value(), 5);
  EXPECT_THAT(small.texts, ElementsAre("1", "2"));
  EXPECT_THAT(unbounded.texts, ElementsAre("1", "2", "3"));
  ASSERT_TRUE(bus.publish("A", bytes_of("4")));
  ASSERT_TRUE(bus.handle(milliseconds(0)));
  EXPECT_THAT(small.texts, ElementsAre("1", "2", "4"));
}

TEST(MemoryBus, CarriesExceptionsOutAndGoesOn) {
  const auto network = std::make_shared<MemoryNetwork>();
  MemoryBus bus(network);
  int calls = 0;
  const auto handler = [&](const ReceivedMessage&) {
    if (++calls == 1) throw std::runtime_error("first");
  };
  ASSERT_TRUE(bus.subscribe("A", handler, 0));
  ASSERT_TRUE(bus.publish("A", bytes_of("1")));
  ASSERT_TRUE(bus.publish("A", bytes_of("2")));
  EXPECT_THROW((void)bus.handle(milliseconds(0)), std::runtime_error);
  EXPECT_EQ(bus.handle(milliseconds(0)).value(), 1);
  EXPECT_EQ(calls, 2);
}

TEST(MemoryBus, WhatAHandlerSendsWaitsForTheNextCall) {
  const auto network = std::make_shared<MemoryNetwork>();
  MemoryBus bus(network);
  ASSERT_TRUE(bus.subscribe(
      "A", [&](const ReceivedMessage& m) { ASSERT_TRUE(bus.publish("A", m.bytes)); }, 0));
  ASSERT_TRUE(bus.publish("A", bytes_of("again")));
  EXPECT_EQ(bus.handle(milliseconds(0)).value(), 1);
  EXPECT_EQ(bus.handle(milliseconds(0)).value(), 1);
}

TEST(MemoryBus, AHandlerMaySubscribe) {
  const auto network = std::make_shared<MemoryNetwork>();
  MemoryBus bus(network);
  Recorder recorder;
  const auto subscribe_many = [&](const ReceivedMessage&) {
    for (int i = 0; i < 100; ++i)
      ASSERT_TRUE(bus.subscribe(std::string("B").append(std::to_string(i)), recorder.handler(), 0));
  };
  ASSERT_TRUE(bus.subscribe("A", subscribe_many, 0));
  ASSERT_TRUE(bus.publish("A", {}));
  ASSERT_TRUE(bus.handle(milliseconds(0)));
  ASSERT_TRUE(bus.publish("B99", bytes_of("x")));
  EXPECT_EQ(bus.handle(milliseconds(0)).value(), 1);
}

TEST(MemoryBus, RefusesWhatLcmWouldRefuse) {
  MemoryBus bus(std::make_shared<MemoryNetwork>(), "EG_");
  EXPECT_FALSE(bus.publish("", {}));
  EXPECT_FALSE(bus.publish("A*", {}));
  EXPECT_FALSE(bus.publish(std::string(61, 'A'), {}));
  EXPECT_TRUE(bus.publish(std::string(60, 'A'), {}));
  EXPECT_FALSE(bus.publish("A", std::vector<std::uint8_t>(kMaxMessageBytes + 1)));
}

/// What arrives of 1000 numbered messages.
std::vector<std::string> send_thousand(const MemoryNetwork::Disturbance& disturbance) {
  const auto network = std::make_shared<MemoryNetwork>(disturbance);
  MemoryBus sender(network), receiver(network);
  Recorder recorder;
  EXPECT_TRUE(receiver.subscribe("A", recorder.handler(), 0));
  for (int i = 1000; i < 2000; ++i) EXPECT_TRUE(sender.publish("A", bytes_of(std::to_string(i))));
  EXPECT_TRUE(receiver.handle(milliseconds(0)));
  return recorder.texts;
}

TEST(MemoryBus, DisturbsAsOftenAsItIsTold) {
  // Five standard deviations of a binomial of 1000 at p = 0.2 are 63.
  EXPECT_NEAR(static_cast<double>(send_thousand({.loss = 0.2, .seed = 1}).size()), 800, 63);
  EXPECT_NEAR(static_cast<double>(send_thousand({.duplication = 0.2, .seed = 2}).size()), 1200, 63);
  auto reordered = send_thousand({.reordering = 0.2, .seed = 3});
  EXPECT_FALSE(std::is_sorted(reordered.begin(), reordered.end()));
  std::sort(reordered.begin(), reordered.end());
  EXPECT_EQ(reordered, send_thousand({}));
}

TEST(MemoryBus, DisturbsTheSameWayForTheSameSeed) {
  const MemoryNetwork::Disturbance disturbance{.loss = 0.1, .duplication = 0.1, .reordering = 0.1, .seed = 7};
  EXPECT_EQ(send_thousand(disturbance), send_thousand(disturbance));
}

}  // namespace
}  // namespace eg::transport
