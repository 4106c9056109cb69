#include "common/transport/machine_fence.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/filter.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace eg::transport {
namespace {

/// The IPv4 addresses of this machine, in host byte order. Also 0.0.0.0: the source of a multicast over the loopback
/// device of a machine that has no other address; the kernel lets none in from outside that has it.
std::vector<std::uint32_t> own_addresses() {
  std::vector<std::uint32_t> addresses = {INADDR_ANY};
  ifaddrs* interfaces = nullptr;
  if (getifaddrs(&interfaces) != 0) return addresses;
  for (const ifaddrs* interface = interfaces; interface != nullptr; interface = interface->ifa_next) {
    if (interface->ifa_addr == nullptr || interface->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::memcpy(&address, interface->ifa_addr, sizeof address);
    addresses.push_back(ntohl(address.sin_addr.s_addr));
  }
  freeifaddrs(interfaces);
  return addresses;
}

/// A classic BPF program that accepts datagrams whose IPv4 source is one of `addresses`.
std::vector<sock_filter> source_filter(const std::vector<std::uint32_t>& addresses) {
  constexpr auto kSourceAddress = static_cast<std::uint32_t>(SKF_NET_OFF) + 12;
  constexpr std::uint32_t kWhole = 0xffffffff;
  std::vector<sock_filter> program = {{BPF_LD | BPF_W | BPF_ABS, 0, 0, kSourceAddress}};
  for (const std::uint32_t address : addresses) {
    program.push_back({BPF_JMP | BPF_JEQ | BPF_K, 0, 1, address});
    program.push_back({BPF_RET | BPF_K, 0, 0, kWhole});
  }
  program.push_back({BPF_RET | BPF_K, 0, 0, 0});
  return program;
}

bool is_udp_socket_on(int descriptor, int port) {
  int type = 0;
  socklen_t size = sizeof type;
  if (getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM) return false;
  sockaddr_in address{};
  size = sizeof address;
  if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0) return false;
  return address.sin_family == AF_INET && ntohs(address.sin_port) == port;
}

}  // namespace

base::Status drop_datagrams_of_other_machines(int port) {
  std::vector<sock_filter> filter = source_filter(own_addresses());
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", failure)) {
    const int descriptor = std::stoi(entry.path().filename().string());
    if (!is_udp_socket_on(descriptor, port)) continue;
    if (setsockopt(descriptor, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof program) != 0) {
      return base::fail("cannot keep the messages of other machines out: " + std::string(std::strerror(errno)));
    }
  }
  if (failure) return base::fail("cannot list the open sockets: " + failure.message());
  return {};
}

}  // namespace eg::transport
