#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/transport/lcm_url.hpp"
#include "tests/support/private_network.hpp"
#include "tests/support/program.hpp"

/// The program itself, in a network that has what LCM needs, or has not.
namespace eg::doctor {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kEnough = 1 << 20;  // bytes of receive buffer that the doctor's own messages need

/// As much receive buffer as this machine gives: what it gives is not what is tested here.
std::string url(int ttl) {
  const std::int64_t limit = transport::kernel_receive_buffer_limit().value_or(0);
  return "--lcm-url=udpm://239.255.76.67:7681?ttl=" + std::to_string(ttl) + "&recv_buf_size=" + std::to_string(limit);
}

TEST(DoctorProgram, FindsNothingWrongWhereThereIsARoute) {
  const std::string why_not = test::enter_private_network(true);
  if (!why_not.empty()) GTEST_SKIP() << why_not;
  if (transport::kernel_receive_buffer_limit().value_or(0) < kEnough) GTEST_SKIP() << "net.core.rmem_max is too small";
  test::Program doctor("egraph-doctor", {url(0), "--seconds", "0.1"});
  EXPECT_EQ(doctor.wait(), 0) << doctor.output();
  EXPECT_THAT(doctor.output(), HasSubstr("ok       10 of 10 test messages"));
  EXPECT_THAT(doctor.output(), Not(HasSubstr("mend:")));
}

TEST(DoctorProgram, PrintsTheCommandThatMakesTheRoute) {
  const std::string why_not = test::enter_private_network(false);
  if (!why_not.empty()) GTEST_SKIP() << why_not;
  test::Program doctor("egraph-doctor", {url(0), "--seconds", "0.1"});
  EXPECT_EQ(doctor.wait(), 1) << doctor.output();
  EXPECT_THAT(doctor.output(), HasSubstr("error    there is no multicast route to 239.255.76.67"));
  EXPECT_THAT(doctor.output(), HasSubstr("mend: ip link set lo up; ip route add 224.0.0.0/4 dev lo"));
}

TEST(DoctorProgram, KnowsThatARouteToItselfReachesNobodyElse) {
  const std::string why_not = test::enter_private_network(true);
  if (!why_not.empty()) GTEST_SKIP() << why_not;
  test::Program doctor("egraph-doctor", {url(1)});
  EXPECT_EQ(doctor.wait(), 1) << doctor.output();
  EXPECT_THAT(doctor.output(), HasSubstr("mend: ip route replace 224.0.0.0/4 dev DEVICE"));
}

}  // namespace
}  // namespace eg::doctor
