#include "services/run/sheriff_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>

namespace eg::run {
namespace {

std::string describe_error(int code) { return std::generic_category().message(code); }

/// In the child. Only calls that are safe after fork in a process with threads.
[[noreturn]] void become_sheriff(const std::array<const char*, 5>& arguments, pid_t parent, int output) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);  // the parent died before the line above
  setsid();
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  execv(arguments[0], const_cast<char* const*>(arguments.data()));  // exec's old signature
  _exit(127);
}

}  // namespace

base::Result<SheriffProcess> SheriffProcess::start(const Program& program) {
  if (access(program.executable.c_str(), X_OK) != 0) {
    return base::fail("cannot run " + program.executable.string() + ": " + describe_error(errno));
  }
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) return base::fail("cannot make a pipe: " + describe_error(errno));
  procman::FileDescriptor reader(pipe_ends[0]);
  const procman::FileDescriptor writer(pipe_ends[1]);
  fcntl(reader.get(), F_SETFL, O_NONBLOCK);

  const std::array<const char*, 5> arguments = {program.executable.c_str(), "--lone-ranger",
                                                program.configuration.c_str(), program.script.c_str(), nullptr};
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) return base::fail("cannot fork: " + describe_error(errno));
  if (pid == 0) become_sheriff(arguments, parent, writer.get());
  return SheriffProcess(pid, std::move(reader), program.log);
}

void SheriffProcess::read_output(const std::function<void(const std::string& line)>& on_line) {
  std::array<char, 4096> buffer;
  ssize_t got = 0;
  while ((got = read(output_.get(), buffer.data(), buffer.size())) > 0) {
    for (const char c : std::string_view(buffer.data(), static_cast<std::size_t>(got))) {
      if (c != '\n') {
        partial_line_ += c;
        continue;
      }
      log_ << partial_line_ << '\n';
      on_line(partial_line_);
      partial_line_.clear();
    }
  }
  log_.flush();
}

bool SheriffProcess::running() {
  if (pid_ != 0 && waitpid(pid_, nullptr, WNOHANG) == pid_) pid_ = 0;
  return pid_ != 0;
}

void SheriffProcess::interrupt() {
  if (pid_ != 0) ::kill(pid_, SIGINT);
}

void SheriffProcess::kill() {
  if (pid_ != 0) ::kill(pid_, SIGKILL);
}

}  // namespace eg::run
