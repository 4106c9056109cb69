#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "common/service/service.hpp"
#include "common/service/service_loop.hpp"
#include "common/transport/prefixed_bus.hpp"

namespace eg::service {

/// What one process runs on its bus: a service, or one for each of several robots. Robots have channel prefixes of
/// their own and share nothing: each has its service with its status, its requests (CONTROL) and its folder,
/// `out`/<prefix>.
class ServiceGroup {
 public:
  /// Makes folders and services. Errors name the robot or folder: a prefix that is there twice or that cannot be the
  /// name of a folder, a folder that cannot be made, what a service says.
  static base::Result<std::unique_ptr<ServiceGroup>> make(transport::Bus& bus, const ServiceProgram& program,
                                                          const ServiceOptions& options);

  /// One step of every loop; waits at most `timeout` in all.
  base::Status step(std::chrono::milliseconds timeout);

  /// True when all services have ended.
  [[nodiscard]] bool ended() const;

  /// Saves the results of all; the first error if there are any.
  base::Status save();

  /// Of every service, the last status.
  void say_goodbye();

 private:
  struct Member {
    Member(transport::Bus& shared, const ServiceOptions& options) : bus(shared, options.robot), context(bus, options) {}

    transport::PrefixedBus bus;
    ServiceContext context;
    std::unique_ptr<Service> service;
    std::unique_ptr<ServiceLoop> loop;
  };

  base::Status add(transport::Bus& bus, const ServiceProgram& program, const ServiceOptions& options);

  std::vector<std::unique_ptr<Member>> members_;
};

}  // namespace eg::service
