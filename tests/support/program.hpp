#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace eg::test {

/// A program of the project, run with its outputs captured. This process becomes a child subreaper, so that nothing the
/// program leaves behind escapes processes_left().
class Program {
 public:
  /// `name` in the folder of the build's programs, or an absolute path.
  Program(const std::string& name, const std::vector<std::string>& arguments);
  /// Kills it if it is still running.
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void send_signal(int signal) const;

  /// Waits for its end. The exit code as a shell has it: 128 + N after signal N; -1 if it takes longer than `limit`.
  int wait(std::chrono::seconds limit = std::chrono::seconds(300));

  /// What it has printed on stdout and stderr so far.
  [[nodiscard]] std::string output() const;

  /// Waits until the output contains `text`; false if it does not within `limit`, or the program ends without.
  bool wait_for_output(const std::string& text, std::chrono::seconds limit = std::chrono::seconds(60));

 private:
  bool poll_exit();

  std::filesystem::path output_file_;
  pid_t pid_ = 0;
  int exit_code_ = -1;
  bool ended_ = false;
};

/// Whether all processes that this one has started, directly or not, are gone within `limit`.
bool no_process_is_left(std::chrono::seconds limit = std::chrono::seconds(5));

/// The process number of a service that a run has announced in its log.txt ("tracker started as process 17"), the
/// latest if it was started again; 0: none.
pid_t service_pid(const std::filesystem::path& log, const std::string& service);

/// The bytes of a file; empty if there is none.
std::string file_bytes(const std::filesystem::path& file);

}  // namespace eg::test
