#include "services/eval/report_command.hpp"

#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "common/io/atomic_file.hpp"
#include "common/io/graph_json.hpp"
#include "common/io/ply.hpp"
#include "common/io/text_file.hpp"
#include "common/io/trajectory_file.hpp"
#include "common/report/run_report.hpp"

namespace eg::service {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A file that a run may not have left is read only if it is there.
fs::path if_there(const fs::path& file) { return fs::exists(file) ? file : fs::path(); }

/// Nothing if there is no name.
base::Status read_trajectory(const fs::path& file, std::vector<geometry::StampedPose>& poses) {
  if (file.empty()) return {};
  auto read = io::read_trajectory(file);
  if (!read) return tl::make_unexpected(read.error());
  poses = std::move(*read);
  return {};
}

/// states.csv: sequence, time, state, and more that is not needed here.
base::Result<std::vector<report::StateSample>> read_states(const fs::path& file) {
  std::vector<report::StateSample> states;
  if (file.empty()) return states;
  const auto text = io::read_file(file);
  if (!text) return tl::make_unexpected(text.error());
  std::istringstream lines(*text);
  std::string line, sequence, time, state;
  std::getline(lines, line);  // names of the columns
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::getline(cells, sequence, ',');
    std::getline(cells, time, ',');
    std::getline(cells, state, ',');
    report::StateSample sample;
    sample.state = state;
    std::from_chars(time.data(), time.data() + time.size(), sample.time_s);
    states.push_back(sample);
  }
  return states;
}

report::ServiceSummary service_from(const std::string& name, const Json& json) {
  report::ServiceSummary service;
  service.name = name;
  service.frames = json.at("frames");
  service.dropped = json.at("dropped");
  service.rejected = json.at("rejected");
  service.latency_p50_ms = json.at("latency_ms").at("p50");
  service.latency_p90_ms = json.at("latency_ms").at("p90");
  service.latency_p99_ms = json.at("latency_ms").at("p99");
  service.latency_max_ms = json.at("latency_ms").at("max");
  service.cpu_seconds = json.at("cpu_seconds");
  service.peak_memory_bytes = json.at("peak_memory_bytes");
  return service;
}

base::Status read_status(const fs::path& file, report::RunResults& run) {
  const auto text = io::read_file(file);
  if (!text) return tl::make_unexpected(text.error());
  try {
    const Json json = Json::parse(*text);
    run.input = json.at("input");
    run.mode = json.at("mode");
    run.outcome = json.at("result");
    const std::string failure = json.at("failure");
    if (!failure.empty()) run.outcome.append(": ").append(failure);
    run.frames = json.at("frames_done");
    run.frames_with_pose = json.at("frames_with_pose");
    run.keyframes = json.at("keyframes");
    run.wall_seconds = json.at("wall_seconds");
    if (!json.contains("services")) return {};
    for (const auto& [name, service] : json.at("services").items()) run.services.push_back(service_from(name, service));
  } catch (const Json::exception& exception) {
    return base::fail(fmt::format("{}: {}", file.string(), exception.what()));
  }
  return {};
}

/// The mesh from four sides; also as files of their own.
base::Status draw_mesh(const fs::path& folder, report::RunResults& run) {
  if (!fs::exists(folder / "mesh.ply")) return {};
  const auto mesh = io::read_ply(folder / "mesh.ply");
  if (!mesh) return tl::make_unexpected(mesh.error());
  if (mesh->triangles.empty()) return {};
  const eval::ColouredSurface surface{{mesh->vertices, mesh->triangles}, mesh->normals, mesh->colours};
  eval::RenderOptions options = run.view;
  options.up = eval::refine_up(surface, options.up);
  run.view.up = options.up;
  options.width = 960;
  options.height = 720;
  const double best = eval::best_azimuth(surface, options);
  for (int quarter = 0; quarter < 4; ++quarter) {
    options.azimuth = best + quarter * std::numbers::pi / 2.0;
    report::Picture picture;
    picture.caption = quarter == 0 ? "from where most is seen" : fmt::format("the same turned by {}°", 90 * quarter);
    cv::imencode(".png", eval::render_scene(surface, {}, {}, options), picture.png);
    const std::string_view bytes(reinterpret_cast<const char*>(picture.png.data()), picture.png.size());
    const fs::path file = folder / fmt::format("report_mesh_{}.png", quarter);
    if (const auto written = io::write_file_atomically(file, bytes); !written) return written;
    run.mesh_views.push_back(std::move(picture));
  }
  return {};
}

}  // namespace

base::Result<Report> report_run(const ReportFiles& files, bool y_up) {
  report::RunResults run;
  run.view = eval::render_options_for(y_up);
  base::Status status = read_status(files.folder / "status.json", run);
  if (status && run.frames_with_pose > 0) {
    status = read_trajectory(if_there(files.folder / "trajectory.txt"), run.estimate);
  }
  if (status) status = read_trajectory(files.groundtruth, run.truth);
  if (status) status = draw_mesh(files.folder, run);
  if (!status) return tl::make_unexpected(status.error());
  auto states = read_states(if_there(files.folder / "states.csv"));
  if (!states) return tl::make_unexpected(states.error());
  run.states = *std::move(states);
  if (fs::exists(files.folder / "egraph.json")) {
    auto graph = io::read_graph(files.folder / "egraph.json");
    if (!graph) return tl::make_unexpected(graph.error());
    run.graph = std::move(*graph);
  }
  base::Result<std::string> settings = "all defaults";
  if (!files.config.empty()) settings = io::read_file(files.config);
  if (!settings) return tl::make_unexpected(settings.error());
  run.settings = *std::move(settings);
  const fs::path out = files.folder / "report.html";
  const std::string html = report::write_report(run);
  if (const auto written = io::write_file_atomically(out, html); !written) return tl::make_unexpected(written.error());
  return Report{out.string() + "\n", {{"report", out.string()}}};
}

}  // namespace eg::service
