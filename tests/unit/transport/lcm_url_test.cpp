#include "common/transport/lcm_url.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eg::transport {
namespace {

using testing::HasSubstr;

TEST(LcmUrl, IsTheDefaultOnItsPort) {
  EXPECT_EQ(lcm_url_for_port(7667), kDefaultLcmUrl);
  EXPECT_THAT(lcm_url_for_port(7700), HasSubstr(":7700?ttl=0&recv_buf_size="));
}

TEST(LcmUrl, KnowsPortAndReach) {
  EXPECT_EQ(udp_port("udpm://239.255.76.67:7700?ttl=1"), 7700);
  EXPECT_EQ(udp_port("udpm://?ttl=1"), 7667);
  EXPECT_EQ(udp_port("udpm://239.255.76.67:70000"), std::nullopt);
  EXPECT_EQ(udp_port("memq://"), std::nullopt);
  EXPECT_EQ(time_to_live(kDefaultLcmUrl), 0);
  EXPECT_EQ(time_to_live("udpm://239.255.76.67:7667"), 0);
  EXPECT_EQ(time_to_live("udpm://239.255.76.67:7667?recv_buf_size=9&ttl=2"), 2);
}

TEST(LcmUrl, AdvisesOnReceiveBuffers) {
  EXPECT_EQ(receive_buffer_advice(kDefaultLcmUrl, 2097152), std::nullopt);
  EXPECT_THAT(receive_buffer_advice(kDefaultLcmUrl, 212992).value(), HasSubstr("sysctl -w net.core.rmem_max=2097152"));
  EXPECT_THAT(receive_buffer_advice("udpm://239.255.76.67:7667?ttl=0", 1 << 30).value(), HasSubstr("recv_buf_size"));
  EXPECT_EQ(receive_buffer_advice("file://run.lcm", 0), std::nullopt);
}

TEST(LcmUrl, IsReadIntoItsParts) {
  const auto url = parse_multicast_url("udpm://239.1.2.3:7700?ttl=1&x=y&recv_buf_size=1000");
  ASSERT_TRUE(url) << url.error().message;
  EXPECT_EQ(url->group, "239.1.2.3");
  EXPECT_EQ(url->port, 7700);
  EXPECT_EQ(url->ttl, 1);
  EXPECT_EQ(url->receive_buffer, 1000);
  const auto defaults = parse_multicast_url("udpm://");
  ASSERT_TRUE(defaults);
  EXPECT_EQ(defaults->group, "239.255.76.67");
  EXPECT_EQ(defaults->port, 7667);
  EXPECT_EQ(defaults->ttl, 0);
  EXPECT_EQ(defaults->receive_buffer, std::nullopt);
  for (const char* wrong : {"memq://", "udpm://1.2.3.4:port", "udpm://1.2.3.4:70000", "udpm://?ttl=256", "udpm://?ttl",
                            "udpm://?recv_buf_size=-1", "udpm://?recv_buf_size=2MB"}) {
    EXPECT_FALSE(parse_multicast_url(wrong)) << wrong;
  }
}

TEST(LcmUrl, ReadsTheKernelsLimit) { EXPECT_GT(kernel_receive_buffer_limit().value_or(0), 0); }

TEST(LcmUrl, OnlyMulticastNeedsARoute) { EXPECT_TRUE(check_multicast_route("memq://")); }

TEST(LcmUrl, RefusesGroupsThatAreNoAddress) {
  const auto status = check_multicast_route("udpm://somewhere:7667?ttl=0");
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("'somewhere'"));
  EXPECT_THAT(check_multicast_route("udpm://10.0.0.1:7667").error().message,
              HasSubstr("'10.0.0.1' in the LCM URL udpm://10.0.0.1:7667 is no multicast address"));
}

}  // namespace
}  // namespace eg::transport
