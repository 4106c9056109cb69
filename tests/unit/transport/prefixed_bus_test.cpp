#include "common/transport/prefixed_bus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/transport/memory_bus.hpp"
#include "tests/unit/transport/recorder.hpp"

namespace eg::transport {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

class PrefixedBusTest : public testing::Test {
 protected:
  PrefixedBusTest() {
    EXPECT_TRUE(a_.subscribe("POSE", heard_by_a_.handler(), 0));
    EXPECT_TRUE(b_.subscribe("POSE", heard_by_b_.handler(), 0));
  }

  std::shared_ptr<MemoryNetwork> network_ = std::make_shared<MemoryNetwork>();
  MemoryBus others_{network_};
  MemoryBus shared_{network_, "site_"};
  PrefixedBus a_{shared_, "a_"};
  PrefixedBus b_{shared_, "b_"};
  Recorder heard_by_a_;
  Recorder heard_by_b_;
};

TEST_F(PrefixedBusTest, EachShareHearsItsOwn) {
  ASSERT_TRUE(others_.publish("site_a_POSE", bytes_of("1")));
  ASSERT_TRUE(others_.publish("site_b_POSE", bytes_of("2")));
  ASSERT_TRUE(others_.publish("site_POSE", bytes_of("3")));
  ASSERT_TRUE(a_.handle(milliseconds(0)));
  EXPECT_THAT(heard_by_a_.texts, ElementsAre("1"));
  EXPECT_THAT(heard_by_a_.channels, ElementsAre("POSE"));
  EXPECT_THAT(heard_by_b_.texts, ElementsAre("2"));
}

TEST_F(PrefixedBusTest, CountsForAShareWhatAnotherHasHandled) {
  for (const char* channel : {"site_a_POSE", "site_b_POSE", "site_b_POSE"}) {
    ASSERT_TRUE(others_.publish(channel, bytes_of("x")));
  }
  EXPECT_EQ(a_.handle(milliseconds(0)).value(), 1);
  EXPECT_EQ(b_.handle(milliseconds(0)).value(), 2);
  EXPECT_EQ(b_.handle(milliseconds(0)).value(), 0);
}

TEST_F(PrefixedBusTest, SpeaksWithBothPrefixes) {
  Recorder recorder;
  ASSERT_TRUE(others_.subscribe("site_b_KEYFRAME", recorder.handler(), 0));
  ASSERT_TRUE(b_.publish("KEYFRAME", bytes_of("k")));
  ASSERT_TRUE(others_.handle(milliseconds(0)));
  EXPECT_THAT(recorder.texts, ElementsAre("k"));
}

TEST_F(PrefixedBusTest, RefusesWhatIsNoChannel) {
  EXPECT_FALSE(a_.publish("", {}));
  EXPECT_FALSE(PrefixedBus(shared_, "a b").publish("POSE", {}));
  EXPECT_FALSE(PrefixedBus(shared_, "a*").subscribe("POSE", heard_by_a_.handler(), 0));
}

}  // namespace
}  // namespace eg::transport
