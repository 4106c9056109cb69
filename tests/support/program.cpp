#include "tests/support/program.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>

#include "common/procman/process_tree.hpp"

namespace eg::test {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPoll{20};

}  // namespace

Program::Program(const std::string& name, const std::vector<std::string>& arguments) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  std::string pattern = (std::filesystem::temp_directory_path() / "egraph-output-XXXXXX").string();
  const int output = mkstemp(pattern.data());
  output_file_ = pattern;

  std::vector<std::string> words = {(std::filesystem::path(EGRAPH_BIN_DIR) / name).string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  close(output);
}

Program::~Program() {
  if (!poll_exit()) {
    send_signal(SIGKILL);
    wait();
  }
  std::filesystem::remove(output_file_);
}

void Program::send_signal(int signal) const {
  if (!ended_) kill(pid_, signal);
}

int Program::wait(std::chrono::seconds limit) {
  const auto end = steady_clock::now() + limit;
  while (!poll_exit() && steady_clock::now() < end) std::this_thread::sleep_for(kPoll);
  return exit_code_;
}

std::string Program::output() const { return file_bytes(output_file_); }

bool Program::wait_for_output(const std::string& text, std::chrono::seconds limit) {
  const auto end = steady_clock::now() + limit;
  while (steady_clock::now() < end) {
    const bool ended = poll_exit();
    if (output().find(text) != std::string::npos) return true;
    if (ended) return false;
    std::this_thread::sleep_for(kPoll);
  }
  return false;
}

bool Program::poll_exit() {
  int status = 0;
  if (ended_ || waitpid(pid_, &status, WNOHANG) != pid_) return ended_;
  ended_ = true;
  exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return true;
}

bool no_process_is_left(std::chrono::seconds limit) {
  const auto end = steady_clock::now() + limit;
  for (;;) {
    // What a program left behind becomes our child, and stays in the list until somebody asks how it ended.
    while (waitpid(-1, nullptr, WNOHANG) > 0) {
    }
    if (procman::find_descendants(getpid()).empty()) return true;
    if (steady_clock::now() > end) return false;
    std::this_thread::sleep_for(kPoll);
  }
}

pid_t service_pid(const std::filesystem::path& log, const std::string& service) {
  const std::string text = file_bytes(log);
  const std::string wanted = service + " started as process ";
  const std::size_t at = text.rfind(wanted);
  return at == std::string::npos ? 0 : std::atoi(text.c_str() + at + wanted.size());
}

std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace eg::test
