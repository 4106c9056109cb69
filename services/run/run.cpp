#include "services/run/run.hpp"

#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "common/procman/configuration.hpp"
#include "common/procman/process_tree.hpp"
#include "common/service/map_archive.hpp"
#include "common/transport/lcm_bus.hpp"
#include "common/transport/web_address.hpp"
#include "services/run/out_folder.hpp"
#include "services/run/own_port.hpp"
#include "services/run/picture.hpp"
#include "services/run/report.hpp"

namespace eg::run {
namespace {

constexpr int kInterruptedExitCode = 130;  ///< what a shell reports for SIGINT

std::filesystem::path own_folder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

std::string script_name(const RunOptions& options) {
  std::string name = options.log ? "log-and-run" : "run";
  name += !options.observations.empty() ? "-observations" : options.mapper ? "" : "-without-mapper";
  return name + (options.view ? "-and-view" : "");
}

/// The procman configuration, found beside the programs' folder unless given, once it is known to be good.
base::Result<std::filesystem::path> find_configuration(const RunOptions& options) {
  const std::filesystem::path file =
      options.procman.empty() ? own_folder().parent_path() / "procman" / "egraph.pmd" : options.procman;
  const auto configuration = procman::load_configuration(file);
  if (!configuration) return tl::make_unexpected(configuration.error());
  if (const auto script = procman::check_script(*configuration, script_name(options)); !script) {
    return tl::make_unexpected(script.error());
  }
  return file;
}

bool is_same(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code none;
  return std::filesystem::equivalent(a, b, none);
}

/// The results of a run replace those of an earlier one, which must not be the map that it goes on in.
base::Status check_map_to_load(const RunOptions& options) {
  if (options.load.empty()) return {};
  const auto file = service::file_in_archive(options.load, service::kSparseMapFile);
  if (!std::filesystem::exists(file)) {
    return base::fail("--load: " + options.load.string() + " holds no map archive (map/sparse.map)");
  }
  if (is_same(file, service::archive_folder(options.out) / service::kSparseMapFile)) {
    return base::fail("--load and --out name the same folder: the map would be replaced by what goes on in it");
  }
  return {};
}

/// Nor must they be the recording, whose ground truth may be called as that of a run, or the configuration.
base::Status check_input_is_elsewhere(const RunOptions& options) {
  for (const std::string& folder : {options.dataset, options.observations}) {
    if (!is_same(folder, options.out)) continue;
    return base::fail("the recording is in the folder of --out, " + folder +
                      ", where results would take the place of its files: choose another");
  }
  if (is_same(options.config, options.out / kSettingsFile)) {
    return base::fail("--config: " + options.config.string() +
                      " would be replaced by this run's: choose another --out");
  }
  return {};
}

/// Where browsers are served; empty: nowhere.
base::Result<std::string> find_web_address(const RunOptions& options) {
  if (!options.view) return std::string();
  if (options.http.empty()) return transport::find_free_web_address();
  if (const auto usable = transport::check_web_address(options.http); !usable) {
    return base::fail("--http: " + usable.error().message);
  }
  return options.http;
}

void set_environment(const char* name, const std::string& value) {
  value.empty() ? unsetenv(name) : setenv(name, value.c_str(), 1);
}

/// What the services are to do, for all of them to inherit.
void set_environment(const RunOptions& options, const Input& input, const std::filesystem::path& out,
                     const std::string& url) {
  set_environment("EGRAPH_LCM_URL", url);
  set_environment("EGRAPH_CHANNEL_PREFIX", "");
  set_environment("EGRAPH_CONFIG", options.config.empty() ? "" : std::filesystem::absolute(options.config).string());
  set_environment("EGRAPH_OUT", out.string());
  set_environment("EGRAPH_LOAD", options.load.empty() ? "" : std::filesystem::absolute(options.load).string());
  set_environment("EGRAPH_LOCKSTEP", options.realtime ? "" : "1");
  set_environment("EGRAPH_DATASET", input.dataset);
  set_environment("EGRAPH_OBSERVATIONS", input.observations);
  set_environment("EGRAPH_DEPTH_NOISE", std::to_string(options.depth_noise));
  set_environment("EGRAPH_CAMERA", input.camera);
  set_environment("EGRAPH_FRAMES", std::to_string(options.frames));
  set_environment("EGRAPH_CONSUMERS", options.mapper ? "tracker,mapper" : "tracker");
  set_environment("EGRAPH_SESSION", std::to_string(input.session));
  set_environment("EGRAPH_LOG_CHANNEL", options.log_channel);
  set_environment("EGRAPH_GROUND_TRUTH",
                  input.ground_truth.empty() ? "" : std::filesystem::absolute(input.ground_truth).string());
  // What this machine's own services may be told otherwise: a run is for one robot, on one input, and begins anew.
  for (const char* name : {"EGRAPH_STATE", "EGRAPH_ROBOTS", "EGRAPH_TILES", "EGRAPH_LIVE", "EGRAPH_OPENNI"}) {
    set_environment(name, "");
  }
}

/// Kills what the sheriff may have left (only if it was itself killed). Returns how many processes there were.
std::size_t kill_leftovers() {
  const std::vector<pid_t> first = procman::find_descendants(getpid());
  for (auto left = first; !left.empty(); left = procman::find_descendants(getpid())) {
    for (const pid_t pid : left) kill(pid, SIGKILL);
    while (waitpid(-1, nullptr, WNOHANG) > 0) {
    }
  }
  return first.size();
}

int report_failure(const std::string& why) {
  spdlog::error(why);
  return 1;
}

/// The tracker's: 130 kB for every frame, and nobody goes on with a run that is complete.
void remove_journal(const std::filesystem::path& out) {
  std::error_code ignored;
  std::filesystem::remove(out / "tracker.journal", ignored);
}

/// After the run, whatever became of it.
int conclude(const RunOptions& options, const Input& input, const std::filesystem::path& out, const Session& session,
             double wall_seconds) {
  RunReport report;
  report.failure = session.failure();
  report.result = session.interrupted() ? "interrupted" : report.failure.empty() ? "complete" : "failed";
  report.wall_seconds = wall_seconds;
  report.processing_seconds = session.processing_seconds();
  if (report.result == "complete") remove_journal(out);
  if (const auto errors = evaluate(out, input); errors) {
    report.errors = *errors;
  } else if (report.failure.empty()) {
    spdlog::warn("no errors against ground truth: {}", errors.error().message);
  }
  if (const auto written = write_status(out / "status.json", options, input, session.monitor(), report); !written) {
    return report_failure(written.error().message);
  }
  if (const auto picture = draw_picture(own_folder() / "egraph-eval", out, input); !picture) {
    spdlog::warn(picture.error().message);
  }
  if (options.report) {
    const auto page = write_report_page(own_folder(), out, input);
    if (!page) return report_failure(page.error().message);
  }
  std::puts(summarise(out, session.monitor(), report).c_str());
  if (session.interrupted()) return kInterruptedExitCode;
  return report.failure.empty() ? 0 : report_failure(report.failure);
}

}  // namespace

int run(const RunOptions& options, const StopCount& stops) {
  const auto input = inspect_input(options);
  if (!input) return report_failure(input.error().message);
  const auto configuration = find_configuration(options);
  if (!configuration) return report_failure(configuration.error().message);
  if (const auto map = check_map_to_load(options); !map) return report_failure(map.error().message);
  if (const auto apart = check_input_is_elsewhere(options); !apart) return report_failure(apart.error().message);
  const auto out = prepare_out_folder(options.out);
  if (!out) return report_failure(out.error().message);
  const auto port = options.lcm_url.empty() ? OwnPort::find() : OwnPort::take(options.lcm_url);
  if (!port) return report_failure(port.error().message);
  const auto web = find_web_address(options);
  if (!web) return report_failure(web.error().message);
  const auto bus = transport::LcmBus::create({port->url(), ""});
  if (!bus) return report_failure(bus.error().message);

  std::printf("%s: %lld frames, %s\n", input->description.c_str(), static_cast<long long>(input->frames),
              options.realtime ? "in real time" : "in lockstep");
  set_environment(options, *input, out->path, port->url());
  set_environment("EGRAPH_HTTP", *web);
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  const Clock::time_point start = Clock::now();
  auto sheriff = SheriffProcess::start(
      {own_folder() / "procman-sheriff", *configuration, script_name(options), out->path / "log.txt"});
  if (!sheriff) return report_failure(sheriff.error().message);
  Session session(options, *input, **bus, *sheriff, stops);
  session.run();
  if (const std::size_t count = kill_leftovers(); count > 0)
    spdlog::warn("{} processes were left and were killed", count);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count() - session.viewing_seconds();
  return conclude(options, *input, out->path, session, seconds);
}

}  // namespace eg::run
