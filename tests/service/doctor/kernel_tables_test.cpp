#include "services/doctor/kernel_tables.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace eg::doctor {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(KernelTables, FindsCountersByName) {
  const char* snmp =
      "Ip: Forwarding ReasmFails\nIp: 1 17\n"
      "UdpLite: InDatagrams RcvbufErrors\nUdpLite: 0 0\n"
      "Udp: InDatagrams NoPorts InErrors OutDatagrams RcvbufErrors\nUdp: 100 2 3 90 42\n";
  EXPECT_EQ(snmp_counter(snmp, "Udp", "RcvbufErrors"), 42);
  EXPECT_EQ(snmp_counter(snmp, "Ip", "ReasmFails"), 17);
  EXPECT_EQ(snmp_counter(snmp, "Udp", "Absent"), std::nullopt);
  EXPECT_EQ(snmp_counter("Udp: A B\nUdp: 1", "Udp", "B"), std::nullopt);
  EXPECT_EQ(snmp_counter("", "Udp", "B"), std::nullopt);
  EXPECT_TRUE(snmp_counter(read_table("/proc/net/snmp"), "Udp", "RcvbufErrors"));
}

TEST(KernelTables, FindsTheDeviceOfTheMostSpecificRoute) {
  const char* route =
      "Iface\tDestination\tGateway\tFlags\tRefCnt\tUse\tMetric\tMask\n"
      "lo\t000000E0\t00000000\t0001\t0\t0\t0\t000000F0\n"
      "eth0\t00000000\t0100A8C0\t0003\t0\t0\t0\t00000000\n";
  EXPECT_EQ(default_device(route), "eth0");
  EXPECT_EQ(device_towards(route, inet_addr("239.255.76.67")), "lo");
  EXPECT_EQ(device_towards(route, inet_addr("192.168.0.7")), "eth0");
  EXPECT_EQ(default_device("Iface\tDestination\n"), std::nullopt);
}

TEST(KernelTables, FindsWhoListensOnAPort) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  socklen_t size = sizeof(address);
  ASSERT_EQ(getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const auto sockets = sockets_on_port(read_table("/proc/net/udp"), ntohs(address.sin_port));
  ASSERT_EQ(sockets.size(), 1U);
  EXPECT_THAT(owner_of_socket(sockets[0]).value_or(""), HasSubstr(std::to_string(getpid())));
  close(descriptor);
  EXPECT_THAT(sockets_on_port(read_table("/proc/net/udp"), ntohs(address.sin_port)), IsEmpty());
  EXPECT_THAT(sockets_on_port("nonsense\n1 2 3\n", 5), IsEmpty());
}

}  // namespace
}  // namespace eg::doctor
