#include "services/run/own_port.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cstddef>

#include "common/transport/lcm_url.hpp"

namespace eg::run {
namespace {

using procman::FileDescriptor;

// Below the range from which the kernel gives ports to others.
constexpr int kFirstPort = 20000;
constexpr int kPorts = 10000;

/// The lock of a port; invalid if somebody else holds it.
FileDescriptor lock_port(int port) {
  FileDescriptor lock(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = "egraph-run/port/" + std::to_string(port);
  std::copy(name.begin(), name.end(), address.sun_path + 1);  // the leading zero makes it abstract
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (bind(lock.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0) lock.reset();
  return lock;
}

/// Whether anything on this machine listens there. LCM itself shares ports, hence the question.
bool is_free(int port) {
  const FileDescriptor probe(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  return bind(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

base::Result<OwnPort> OwnPort::find() {
  const int start = getpid() % kPorts;  // runs started together do not try the same ones
  for (int i = 0; i < kPorts; ++i) {
    const int port = kFirstPort + (start + i) % kPorts;
    FileDescriptor lock = lock_port(port);
    if (lock.valid() && is_free(port)) return OwnPort(transport::lcm_url_for_port(port), std::move(lock));
  }
  return base::fail("there is no free UDP port between " + std::to_string(kFirstPort) + " and " +
                    std::to_string(kFirstPort + kPorts - 1));
}

base::Result<OwnPort> OwnPort::take(const std::string& url) {
  const std::optional<int> port = transport::udp_port(url);
  if (!port) return OwnPort(url, FileDescriptor());
  FileDescriptor lock = lock_port(*port);
  if (!lock.valid()) {
    return base::fail("port " + std::to_string(*port) +
                      " is in use by another egraph-run; choose another in --lcm-url");
  }
  return OwnPort(url, std::move(lock));
}

}  // namespace eg::run
