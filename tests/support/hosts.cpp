#include "tests/support/hosts.hpp"

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "common/base/check.hpp"

namespace eg::test {
namespace {

using procman::FileDescriptor;

FileDescriptor this_network() { return FileDescriptor(open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC)); }

base::Result<FileDescriptor> new_network() {
  if (unshare(CLONE_NEWNET) != 0) return base::fail(std::string("no network namespace: ") + std::strerror(errno));
  return this_network();
}

std::string path_of(const FileDescriptor& network) {
  return "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(network.get());
}

/// Runs commands of ip(8) in the network in which this thread is.
base::Status ip(const std::vector<std::string>& commands) {
  for (const std::string& command : commands) {
    const std::string line = "ip " + command + " 2>&1";
    if (std::system(line.c_str()) != 0) return base::fail("'ip " + command + "' failed");
  }
  return {};
}

}  // namespace

base::Result<std::unique_ptr<Hosts>> Hosts::make(int count) {
  std::unique_ptr<Hosts> hosts(new Hosts);
  if (const base::Status built = hosts->build(count); !built) return tl::make_unexpected(built.error());
  return hosts;
}

Hosts::~Hosts() { setns(before_.get(), CLONE_NEWNET); }

void Hosts::enter(int host) const {
  EG_CHECK(setns(hosts_.at(static_cast<std::size_t>(host)).get(), CLONE_NEWNET) == 0, "root may change the network");
}

base::Status Hosts::build(int count) {
  before_ = this_network();
  auto bridge = new_network();
  if (!bridge) return tl::make_unexpected(bridge.error());
  switch_ = *std::move(bridge);
  if (const auto done = ip({"link add br0 type bridge mcast_snooping 0", "link set br0 up"}); !done) return done;
  for (int host = 0; host < count; ++host) {
    auto network = new_network();
    if (!network) return tl::make_unexpected(network.error());
    const std::string port = "port" + std::to_string(host);
    const std::string address = "10.77.0." + std::to_string(host + 1) + "/24";
    const auto here =
        ip({"link set lo up", "link add eth0 type veth peer name " + port + " netns " + path_of(switch_),
            "address add " + address + " dev eth0", "link set eth0 up", "route add 224.0.0.0/4 dev eth0"});
    if (!here) return here;
    hosts_.push_back(*std::move(network));
    EG_CHECK(setns(switch_.get(), CLONE_NEWNET) == 0, "root may change the network");
    if (const auto there = ip({"link set " + port + " master br0 up"}); !there) return there;
  }
  return {};
}

}  // namespace eg::test
