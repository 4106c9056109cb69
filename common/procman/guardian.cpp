#include "common/procman/guardian.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <initializer_list>

#include "common/procman/process_tree.hpp"

namespace eg::procman {
namespace {

const std::initializer_list<int> kStopSignals = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};

volatile std::sig_atomic_t worker = 0;
volatile std::sig_atomic_t stops = 0;

int guardian_died_signal() { return SIGRTMAX; }  // which nobody else sends

void pass_on(int signal) { kill(worker, signal); }
void count_stop(int /*signal*/) { stops = stops + 1; }
void stop_at_once(int /*signal*/) { stops = kStopAtOnce; }

void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(signal, &action, nullptr);
}

int run_worker(pid_t guardian, const std::function<int()>& work, const sigset_t& mask) {
  for (const int signal : kStopSignals) handle(signal, count_stop);
  handle(guardian_died_signal(), stop_at_once);
  prctl(PR_SET_PDEATHSIG, guardian_died_signal());
  if (getppid() != guardian) return 1;  // it died before the line above
  setpgid(0, 0);                        // what a terminal sends to its group comes once, from the guardian
  sigprocmask(SIG_SETMASK, &mask, nullptr);
  return work();
}

/// The exit code of the worker as a shell has it.
int wait_for_worker() {
  while (true) {
    int status = 0;
    const pid_t ended = waitpid(-1, &status, 0);  // also orphans
    if (ended == worker) return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (ended < 0 && errno != EINTR) return 1;
  }
}

/// Whoever loses its parent becomes a child of this process, so that nobody is left when it has no child. That the list
/// of processes shows none is no proof: one that is born while the list is read is not in it.
void kill_what_is_left() {
  pid_t reaped = 0;
  while (reaped >= 0) {
    for (const pid_t pid : find_descendants(getpid())) kill(pid, SIGKILL);
    do {
      reaped = waitpid(-1, nullptr, WNOHANG);
    } while (reaped > 0);
  }
}

}  // namespace

int run_guarded(const std::function<int()>& work) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  const pid_t guardian = getpid();
  // Signals wait until both processes know what to do with them.
  sigset_t all;
  sigset_t mask;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, &mask);
  const pid_t child = fork();
  if (child <= 0) return run_worker(child == 0 ? guardian : getppid(), work, mask);  // if need be without a guardian
  worker = child;
  for (const int signal : kStopSignals) handle(signal, pass_on);
  sigprocmask(SIG_SETMASK, &mask, nullptr);
  const int exit_code = wait_for_worker();
  kill_what_is_left();
  return exit_code;
}

int stop_count() { return stops; }

}  // namespace eg::procman
