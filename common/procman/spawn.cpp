#include "common/procman/spawn.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <system_error>

namespace eg::procman {
namespace {

std::string describe_error(int code) { return std::generic_category().message(code); }

struct Terminal {
  FileDescriptor master;
  FileDescriptor slave;
};

/// A pseudo-terminal in raw mode, so that programs send their lines at once and bytes pass unchanged.
base::Result<Terminal> open_terminal() {
  Terminal terminal;
  terminal.master.reset(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  std::array<char, 64> name{};
  if (!terminal.master.valid() || grantpt(terminal.master.get()) != 0 || unlockpt(terminal.master.get()) != 0 ||
      ptsname_r(terminal.master.get(), name.data(), name.size()) != 0) {
    return base::fail("cannot open a pseudo-terminal: " + describe_error(errno));
  }
  terminal.slave.reset(open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!terminal.slave.valid()) return base::fail("cannot open a pseudo-terminal: " + describe_error(errno));
  termios settings{};
  if (tcgetattr(terminal.slave.get(), &settings) == 0) {
    cfmakeraw(&settings);
    tcsetattr(terminal.slave.get(), TCSANOW, &settings);
  }
  return terminal;
}

void restore_default_signals() {
  for (int number = 1; number < NSIG; ++number)
    std::signal(number, SIG_DFL);  // SIGKILL and SIGSTOP refuse, which is fine
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// In the child, after fork. Returns only when something failed, with errno.
int become(const ExecLine& line, pid_t parent, int terminal) {
  restore_default_signals();
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return errno;
  if (getppid() != parent) return ECHILD;  // the parent died before the line above
  if (setsid() < 0 || ioctl(terminal, TIOCSCTTY, 0) != 0) return errno;
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (dup2(terminal, standard) < 0) return errno;
  }
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);  // LCM, for one, leaves its sockets to everybody
  for (const auto& [name, value] : line.environment) setenv(name.c_str(), value.c_str(), 1);
  std::vector<char*> arguments;
  for (const std::string& word : line.words)
    arguments.push_back(const_cast<char*>(word.c_str()));  // exec's old signature
  arguments.push_back(nullptr);
  execvp(arguments.front(), arguments.data());
  return errno;
}

}  // namespace

base::Result<SpawnedProcess> spawn(const ExecLine& line) {
  auto terminal = open_terminal();
  if (!terminal) return tl::make_unexpected(terminal.error());
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) return base::fail("cannot make a pipe: " + describe_error(errno));
  FileDescriptor failure_reader(pipe_ends[0]);
  FileDescriptor failure_writer(pipe_ends[1]);

  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) return base::fail("cannot fork: " + describe_error(errno));
  if (pid == 0) {
    const int code = become(line, parent, terminal->slave.get());
    const ssize_t ignored = write(failure_writer.get(), &code, sizeof code);
    _exit(ignored == sizeof code ? 127 : 126);
  }
  // exec closes the writing end, so that the reader sees its end: the program is loaded.
  failure_writer.reset();
  int code = 0;
  ssize_t got = 0;
  while ((got = read(failure_reader.get(), &code, sizeof code)) < 0 && errno == EINTR) {
  }
  if (got == static_cast<ssize_t>(sizeof code)) {
    while (waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
    }
    return base::fail("cannot run " + line.words.front() + ": " + describe_error(code));
  }
  return SpawnedProcess{pid, std::move(terminal->master)};
}

}  // namespace eg::procman
