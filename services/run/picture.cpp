#include "services/run/picture.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <vector>

namespace eg::run {
namespace {

/// Runs a program to its end; both outputs are appended to `log`. Returns its wait status, or -1 if it could not be
/// started.
int run_program(const std::vector<std::string>& words, const std::filesystem::path& log) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));  // exec's old signature
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t pid = 0;
  const int failure = posix_spawn(&pid, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) return -1;
  int wait_status = -1;
  while (waitpid(pid, &wait_status, 0) < 0 && errno == EINTR) {
  }
  return wait_status;
}

}  // namespace

base::Status draw_picture(const std::filesystem::path& egraph_eval, const std::filesystem::path& out,
                          const Input& input) {
  std::vector<std::string> words = {egraph_eval.string(), "render", "--out", (out / "picture.png").string()};
  const auto add_if_there = [&](const char* option, const std::filesystem::path& file) {
    if (!std::filesystem::exists(file)) return;
    words.emplace_back(option);
    words.push_back(file.string());
  };
  add_if_there("--mesh", out / "mesh.ply");
  add_if_there("--trajectory", out / "trajectory.txt");
  add_if_there("--graph", out / "egraph.json");
  add_if_there("--groundtruth", input.ground_truth);
  if (input.y_up) words.emplace_back("--y-up");
  if (run_program(words, out / "log.txt") != 0) return base::fail("no picture could be drawn; log.txt says why");
  return {};
}

}  // namespace eg::run
