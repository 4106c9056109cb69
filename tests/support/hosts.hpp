#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/procman/file_descriptor.hpp"

namespace eg::test {

/// Machines in one network segment: network namespaces, each with an interface eth0 (10.77.0.1, 10.77.0.2, ...) that a
/// veth pair joins to a bridge in a namespace of its own, and a multicast route over it. Needs root.
class Hosts {
 public:
  /// An error says why the machine does not permit it.
  static base::Result<std::unique_ptr<Hosts>> make(int count);
  /// Goes back to where it was made.
  ~Hosts();
  Hosts(const Hosts&) = delete;
  Hosts& operator=(const Hosts&) = delete;

  /// Moves this thread to a host: sockets it opens and processes it starts from now on are there.
  void enter(int host) const;

 private:
  Hosts() = default;
  base::Status build(int count);

  procman::FileDescriptor before_;
  procman::FileDescriptor switch_;
  std::vector<procman::FileDescriptor> hosts_;
};

}  // namespace eg::test
