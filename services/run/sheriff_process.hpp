#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

#include "common/base/result.hpp"
#include "common/procman/file_descriptor.hpp"

namespace eg::run {

/// procman-sheriff as a child in a session of its own (Ctrl-C in a terminal reaches egraph-run only, which then
/// decides). If egraph-run dies, the kernel tells the sheriff to stop, and it stops the services.
class SheriffProcess {
 public:
  struct Program {
    std::filesystem::path executable;
    std::filesystem::path configuration;
    std::string script;
    std::filesystem::path log;  ///< everything that it and the services print
  };

  /// The services inherit this process's environment.
  static base::Result<SheriffProcess> start(const Program& program);

  /// Reads what has been printed since, without waiting; `on_line` gets each line.
  void read_output(const std::function<void(const std::string& line)>& on_line);

  /// True until it has ended.
  bool running();

  /// SIGINT: the first asks it to stop everything, the second to kill everything.
  void interrupt();

  /// The end of the last resort: the kernel then kills its children.
  void kill();

 private:
  SheriffProcess(pid_t pid, procman::FileDescriptor output, const std::filesystem::path& log)
      : pid_(pid), output_(std::move(output)), log_(log) {}

  pid_t pid_ = 0;  ///< 0: has ended
  procman::FileDescriptor output_;
  std::ofstream log_;
  std::string partial_line_;
};

}  // namespace eg::run
