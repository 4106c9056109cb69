#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/transport/lcm_bus.hpp"
#include "tests/support/hosts.hpp"
#include "tests/support/program.hpp"

namespace eg::test {

/// Machines with a procman-deputy each, and a sheriff on the first that carries out a configuration of the project. The
/// recording is the synthetic room, in lockstep.
class Fleet {
 public:
  struct Options {
    std::string configuration;          ///< file name in procman/
    std::vector<std::string> deputies;  ///< names, one machine each
    std::filesystem::path out;          ///< of all services
    int frames = 20;
  };

  /// Starts deputies and sheriff. `hosts` has as many machines as there are deputies.
  Fleet(const Hosts& hosts, const Options& options);

  /// Waits until the tracker has answered `count` more frames.
  bool wait_for_poses(int count, std::chrono::seconds limit);

  /// Waits until the source has announced the end of the stream, which it does when all consumers have had all frames.
  bool wait_for_end(std::chrono::seconds limit);

  /// Has a sheriff stop all services, which save. Returns its exit code.
  int stop();

  /// SIGKILL to a service, wherever it runs; false if it does not run.
  bool kill_service(const std::string& program);

  [[nodiscard]] std::string output() const;

 private:
  bool handle_until(const std::function<bool()>& condition, std::chrono::seconds limit);
  std::vector<std::string> sheriff_arguments(const std::string& script) const;

  const Hosts& hosts_;
  Options options_;
  std::map<std::string, std::unique_ptr<Program>> deputies_;
  std::unique_ptr<Program> sheriff_;
  std::unique_ptr<transport::LcmBus> bus_;
  int poses_ = 0;
  bool ended_ = false;
};

}  // namespace eg::test
