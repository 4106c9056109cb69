#include "tests/support/private_network.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <net/route.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace eg::test {
namespace {

std::string failure(const char* what) { return std::string(what) + ": " + std::strerror(errno); }

sockaddr ipv4(const char* address) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  inet_pton(AF_INET, address, &in.sin_addr);
  sockaddr result{};
  std::memcpy(&result, &in, sizeof(result));
  return result;
}

bool bring_loopback_up(int descriptor) {
  ifreq request{};
  std::strncpy(request.ifr_name, "lo", IFNAMSIZ - 1);
  request.ifr_flags = IFF_UP | IFF_LOOPBACK | IFF_RUNNING | IFF_MULTICAST;
  return ioctl(descriptor, SIOCSIFFLAGS, &request) == 0;
}

bool add_multicast_route(int descriptor) {
  char device[] = "lo";
  rtentry route{};
  route.rt_dst = ipv4("224.0.0.0");
  route.rt_genmask = ipv4("240.0.0.0");
  route.rt_flags = RTF_UP;
  route.rt_dev = device;
  return ioctl(descriptor, SIOCADDRT, &route) == 0;
}

}  // namespace

std::string enter_private_network(bool with_multicast_route) {
  // Root needs no user namespace; who is not root becomes so within one, where that is allowed.
  const int namespaces = geteuid() == 0 ? CLONE_NEWNET : CLONE_NEWUSER | CLONE_NEWNET;
  if (unshare(namespaces) != 0) return failure("no network namespace");
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  if (descriptor < 0) return failure("no socket");
  std::string error;
  if (!bring_loopback_up(descriptor)) error = failure("the loopback device stays down");
  if (error.empty() && with_multicast_route && !add_multicast_route(descriptor)) error = failure("no multicast route");
  close(descriptor);
  return error;
}

}  // namespace eg::test
