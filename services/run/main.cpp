#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <initializer_list>

#include "common/service/logging.hpp"
#include "services/run/run.hpp"

namespace {

volatile std::sig_atomic_t stop_signals = 0;

void count_signal(int /*signal*/) { stop_signals = stop_signals + 1; }

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = count_signal;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // whoever reads the progress may go first
}

}  // namespace

int main(int argc, char** argv) {
  eg::service::log_to_stderr("egraph-run");
  eg::run::RunOptions options;
  bool no_mapper = false;
  CLI::App app("Runs the whole system on a recording: trajectory, E-Graph and mesh into a folder", "egraph-run");
  auto* input = app.add_option_group("input", "what to run on")->require_option(1);
  input->add_option("--dataset", options.dataset,
                    "Folder in TUM RGB-D or ICL-NUIM layout, or synthetic:SCENE[:TRAJECTORY]");
  input->add_option(
      "--observations", options.observations,
      "Feature-level data: folder in the format of Open-Structure, or synthetic:walk; implies --no-mapper");
  auto* log_in = input->add_option("--log-in", options.log_in, "LCM log of an earlier run or of a robot, to replay");
  app.add_option("--session", options.session, "Which of the log's sessions, if there are several")->needs(log_in);
  app.add_option("--log-channel", options.log_channel, "Where the log's frames are, if on several channels")
      ->needs(log_in);
  app.add_option("--camera", options.camera, "Camera by name or YAML file; without it found from the data set");
  app.add_option("--out", options.out, "Folder for the results; those of an earlier run are replaced")->required();
  app.add_option("--load", options.load, "Results of an earlier run: find the camera in their map and go on in it")
      ->check(CLI::ExistingDirectory);
  app.add_flag("--realtime", options.realtime, "At the sensor's rate, dropping frames, instead of in lockstep");
  app.add_flag("--no-mapper", no_mapper, "Without the dense map");
  app.add_option("--config", options.config, "YAML configuration with a section for each service")
      ->check(CLI::ExistingFile);
  app.add_option("--frames", options.frames, "Process at most this many frames; 0: all")
      ->check(CLI::Range(std::int64_t{0}, INT64_MAX));
  app.add_option("--depth-noise", options.depth_noise,
                 "Add the noise of a structured-light camera to the data set's depth, with this seed; 0: none")
      ->check(CLI::Range(std::int64_t{0}, INT64_MAX));
  app.add_flag("--report", options.report, "Describe the run in one report.html, with pictures and plots");
  app.add_flag("--view", options.view,
               "Show the run in web browsers; on a terminal until Ctrl-C, also when it is over");
  app.add_option("--http", options.http,
                 "Address and port that --view serves browsers at; without it 127.0.0.1:8080, or a free port after it")
      ->envname("EGRAPH_HTTP");
  app.add_flag("--log", options.log, "Record all messages into run.lcm with lcm-logger");
  app.add_option("--procman", options.procman, "procman configuration to start the services from");
  app.add_option("--lcm-url", options.lcm_url, "LCM provider to run on; without it a port of this run's own");
  CLI11_PARSE(app, argc, argv);
  options.keep_view = options.view && isatty(STDIN_FILENO) == 1;
  options.mapper = !no_mapper && options.observations.empty();

  catch_signals();
  try {
    return eg::run::run(options, [] { return static_cast<int>(stop_signals); });
  } catch (const std::exception& exception) {
    spdlog::error(exception.what());
    return 1;
  }
}
