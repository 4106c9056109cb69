#include "services/run/picture.hpp"

#include <string>
#include <vector>

#include "common/procman/run_program.hpp"

namespace eg::run {

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
  const auto exit_code = procman::run_program(words, out / "log.txt");
  if (!exit_code) return base::fail(exit_code.error().message);
  if (*exit_code != 0) return base::fail("no picture could be drawn; log.txt says why");
  return {};
}

}  // namespace eg::run
