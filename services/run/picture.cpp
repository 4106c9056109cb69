#include "services/run/picture.hpp"

#include <string>
#include <vector>

#include "common/procman/run_program.hpp"
#include "services/run/out_folder.hpp"

namespace eg::run {
namespace {

/// Runs a program whose output goes to the log. `failure`: what to say when it fails.
base::Status run_to_end(const std::vector<std::string>& words, const std::filesystem::path& out,
                        const std::string& failure) {
  const auto exit_code = procman::run_program(words, out / "log.txt");
  if (!exit_code) return base::fail(exit_code.error().message);
  return *exit_code == 0 ? base::Status{} : base::fail(failure + "; log.txt says why");
}

/// What every service says is in force; they read the configuration that the run has put into the environment. The file
/// is a configuration itself.
base::Status write_settings(const std::filesystem::path& programs, const std::filesystem::path& file) {
  std::filesystem::remove(file);
  for (const char* service :
       {"egraph-frame-source", "egraph-feature-extractor", "egraph-tracker", "egraph-server", "egraph-mapper"}) {
    const auto exit_code = procman::run_program({(programs / service).string(), "--print-config"}, file);
    if (!exit_code) return base::fail(exit_code.error().message);
    if (*exit_code != 0) return base::fail(std::string(service) + " does not say what it is configured with");
  }
  return {};
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
  return run_to_end(words, out, "no picture could be drawn");
}

base::Status write_report_page(const std::filesystem::path& programs, const std::filesystem::path& out,
                               const Input& input) {
  const std::filesystem::path settings = out / kSettingsFile;
  if (const auto written = write_settings(programs, settings); !written) return written;
  std::vector<std::string> words = {(programs / "egraph-eval").string(), "report", out.string(), "--config",
                                    settings.string()};
  if (std::filesystem::exists(input.ground_truth)) {
    words.insert(words.end(), {"--groundtruth", input.ground_truth.string()});
  }
  if (input.y_up) words.emplace_back("--y-up");
  return run_to_end(words, out, "no report could be written");
}

}  // namespace eg::run
