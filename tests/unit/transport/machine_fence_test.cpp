#include "common/transport/machine_fence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/transport/lcm_bus.hpp"
#include "tests/support/hosts.hpp"
#include "tests/unit/transport/recorder.hpp"

namespace eg::transport {
namespace {

using testing::ElementsAre;

std::unique_ptr<LcmBus> open_bus(int ttl, bool only_this_machine = false) {
  const std::string url = "udpm://239.255.76.67:7998?ttl=" + std::to_string(ttl);
  auto bus = LcmBus::create({.url = url, .channel_prefix = "", .only_this_machine = only_this_machine});
  EXPECT_TRUE(bus) << bus.error().message;
  return bus ? std::move(*bus) : nullptr;
}

void receive(Bus& bus) {
  while (bus.handle(std::chrono::milliseconds(200)).value_or(0) > 0) {
  }
}

TEST(MachineFence, KeepsOtherMachinesOut) {
  const auto hosts = test::Hosts::make(2);
  if (!hosts) GTEST_SKIP() << hosts.error().message;
  (*hosts)->enter(0);
  const auto fenced = open_bus(0, true);
  const auto open = open_bus(0);
  const auto neighbour = open_bus(0);
  const auto speaks_out = open_bus(1);
  ASSERT_TRUE(fenced && open && neighbour && speaks_out);
  Recorder fenced_heard;
  Recorder open_heard;
  ASSERT_TRUE(fenced->subscribe("A", fenced_heard.handler(), 0));  // opens a socket where this thread is
  ASSERT_TRUE(open->subscribe("A", open_heard.handler(), 0));
  (*hosts)->enter(1);
  const auto stranger = open_bus(1);
  const auto quiet_stranger = open_bus(0);
  ASSERT_TRUE(stranger && quiet_stranger);
  ASSERT_TRUE(stranger->publish("A", bytes_of("stranger")));
  ASSERT_TRUE(quiet_stranger->publish("A", bytes_of("quiet stranger")));
  ASSERT_TRUE(neighbour->publish("A", bytes_of("neighbour")));
  ASSERT_TRUE(speaks_out->publish("A", bytes_of("speaks out")));
  receive(*fenced);
  receive(*open);
  EXPECT_THAT(fenced_heard.texts, ElementsAre("neighbour", "speaks out"));
  // ttl=0 alone does not keep them out, which is why there is a fence.
  EXPECT_THAT(open_heard.texts, ElementsAre("stranger", "neighbour", "speaks out"));
}

}  // namespace
}  // namespace eg::transport
