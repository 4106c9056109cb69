#include "common/procman/supervised_command.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "common/procman/process_tree.hpp"

namespace eg::procman {
namespace {

constexpr std::chrono::milliseconds kFirstRespawnPause{10};
constexpr std::chrono::milliseconds kLastRespawnPause{1000};
constexpr char kMarkerName[] = "PROCMAN_COMMAND_ID";
/// Output taken from one command at a time: one that never stops printing must not keep the others waiting. Its
/// terminal then holds it back.
constexpr int kReadsAtOnce = 16;

std::string make_marker(CommandId id) {
  return std::string(kMarkerName) + "=" + std::to_string(getpid()) + ":" + std::to_string(id);
}

/// The wait status of a shell that could not start what it was to run.
constexpr int kNotStarted = 127 << 8;

}  // namespace

std::string describe_wait_status(int wait_status) {
  if (WIFSIGNALED(wait_status)) {
    const int number = WTERMSIG(wait_status);
    const char* const description = sigdescr_np(number);  // null for those of real time
    return "signal " + std::to_string(number) + (description != nullptr ? " (" + std::string(description) + ")" : "");
  }
  return "exit status " + std::to_string(WEXITSTATUS(wait_status));
}

SupervisedCommand::SupervisedCommand(CommandId id, Command command, const CommandListener& listener)
    : id_(id),
      command_(std::move(command)),
      marker_(make_marker(id)),
      listener_(listener),
      respawn_pause_(kFirstRespawnPause) {}

void SupervisedCommand::start(Clock::time_point now) {
  if (state_ == CommandState::stopping) {
    start_when_stopped_ = true;
  } else if (state_ != CommandState::running) {
    respawn_pause_ = kFirstRespawnPause;
    launch(now);
  }
}

void SupervisedCommand::stop(Clock::time_point now) {
  start_when_stopped_ = false;
  if (state_ == CommandState::respawning) state_ = CommandState::stopped;
  if (state_ != CommandState::running) return;
  state_ = CommandState::stopping;
  deadline_ = now + command_.stop_time_allowed;
  signal_all(command_.stop_signal);
}

void SupervisedCommand::restart(Clock::time_point now) {
  stop(now);
  start(now);
}

void SupervisedCommand::tick(Clock::time_point now) {
  if (state_ == CommandState::respawning && now >= deadline_) launch(now);
  if (state_ != CommandState::stopping) return;
  if (process_.pid == 0 && find_members(session_, marker_).empty()) {
    finish_stop(now);
  } else if (now >= deadline_) {
    signal_all(SIGKILL);
  }
}

void SupervisedCommand::handle_exit(int wait_status, Clock::time_point now) {
  read_output();
  process_ = {};
  wait_status_ = wait_status;
  const bool clean = WIFEXITED(wait_status) && WEXITSTATUS(wait_status) == 0;
  if (state_ == CommandState::stopping) {
    const bool as_asked = WIFSIGNALED(wait_status) && WTERMSIG(wait_status) == command_.stop_signal;
    outcome_ = clean || as_asked ? Outcome::ok : Outcome::error;
    listener_.on_event(id_, "stopped with " + describe_wait_status(wait_status));
    tick(now);
    return;
  }
  signal_all(SIGKILL);  // what it leaves behind
  outcome_ = clean ? Outcome::ok : Outcome::error;
  const std::string how = "ended with " + describe_wait_status(wait_status);
  (clean ? listener_.on_event : listener_.on_problem)(id_, how);
  if (command_.auto_respawn) {
    schedule_respawn(now);
  } else {
    state_ = CommandState::stopped;
  }
}

void SupervisedCommand::read_output() {
  std::array<char, 4096> buffer;
  for (int reads = 0; reads < kReadsAtOnce && process_.output.valid(); ++reads) {
    const ssize_t got = read(process_.output.get(), buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno == EAGAIN) return;
    if (got <= 0) {  // EIO: nobody has the terminal open any more
      process_.output.reset();
      return;
    }
    listener_.on_output(id_, {buffer.data(), static_cast<std::size_t>(got)});
  }
}

void SupervisedCommand::launch(Clock::time_point now) {
  outcome_ = Outcome::none;
  wait_status_ = 0;
  started_ = now;
  base::Result<ExecLine> line = parse_exec(command_.exec, look_up_in_environment);
  base::Result<SpawnedProcess> process = tl::make_unexpected(base::Error{});
  if (line) {
    const std::size_t equals = marker_.find('=');
    line->environment.emplace_back(marker_.substr(0, equals), marker_.substr(equals + 1));
    process = spawn(*line);
  }
  if (!line || !process) {
    outcome_ = Outcome::error;
    wait_status_ = kNotStarted;
    state_ = CommandState::stopped;
    listener_.on_problem(id_, "could not be started: " + (line ? process.error() : line.error()).message);
    if (line && command_.auto_respawn) schedule_respawn(now);
    return;
  }
  process_ = std::move(*process);
  session_ = process_.pid;
  state_ = CommandState::running;
  listener_.on_event(id_, "started as process " + std::to_string(process_.pid));
}

void SupervisedCommand::signal_all(int signal) const {
  for (const pid_t pid : find_members(session_, marker_)) ::kill(pid, signal);
}

void SupervisedCommand::finish_stop(Clock::time_point now) {
  state_ = CommandState::stopped;
  if (std::exchange(start_when_stopped_, false)) start(now);
}

/// Pauses double from 10 ms to 1 s; a run of more than a second starts over.
void SupervisedCommand::schedule_respawn(Clock::time_point now) {
  if (now - started_ > kLastRespawnPause) respawn_pause_ = kFirstRespawnPause;
  deadline_ = now + respawn_pause_;
  respawn_pause_ = std::min<Clock::duration>(2 * respawn_pause_, kLastRespawnPause);
  state_ = CommandState::respawning;
}

}  // namespace eg::procman
