#include "common/report/run_report.hpp"

#include <spdlog/fmt/fmt.h>

#include <map>

#include "common/eval/alignment.hpp"
#include "common/geometry/so3.hpp"
#include "common/report/html.hpp"
#include "common/report/views.hpp"

namespace eg::report {
namespace {

constexpr double kMegabyte = 1e6;
/// Fewer shared features are no covisibility edge for systems that work on it.
constexpr int kMinShared = 15;
constexpr double kDegrees = 57.29577951308232;

std::string tile(const std::string& value, const std::string& what) {
  return fmt::format("<div><b>{}</b><span>{}</span></div>\n", value, what);
}

std::string tiles(const RunResults& run, const std::optional<eval::TrajectoryErrors>& errors) {
  std::string html = "<div class=\"tiles\">\n";
  if (errors) {
    html += tile(fmt::format("{:.1f} mm", 1000.0 * errors->ate_m.rmse), "position error, RMSE (ATE)");
    html += tile(fmt::format("{:.3f}°", errors->are_aligned_deg.mean), "rotation error, mean (ARE)");
  }
  html += tile(fmt::format("{} of {}", run.frames_with_pose, run.frames), "frames with a pose");
  html += tile(fmt::format("{}", run.keyframes), "keyframes");
  html += tile(fmt::format("{}", run.graph.edges.size()), "E-Graph edges");
  html += tile(fmt::format("{:.1f} s", run.wall_seconds), fmt::format("wall time, {}", escape(run.mode)));
  return html.append("</div>\n");
}

/// The part of the truth in the estimate's time: a run may have taken the first frames of a recording only.
std::vector<geometry::StampedPose> truth_during_run(const RunResults& run) {
  std::vector<geometry::StampedPose> truth;
  for (const geometry::StampedPose& pose : run.truth) {
    if (pose.time_s >= run.estimate.front().time_s && pose.time_s <= run.estimate.back().time_s) truth.push_back(pose);
  }
  return truth;
}

Points positions_of(const std::vector<geometry::StampedPose>& trajectory, const geometry::Pose& motion) {
  Points points;
  for (const auto& [time, pose] : trajectory) points.push_back(motion * pose.translation);
  return points;
}

std::string trajectory_section(const RunResults& run, const std::vector<eval::PosePair>& pairs) {
  const geometry::Pose estimate_from_truth = pairs.empty() ? geometry::Pose{} : eval::align_positions(pairs).inverse();
  const Points truth = pairs.empty() ? Points{} : positions_of(truth_during_run(run), estimate_from_truth);
  std::string html = draw_trajectories(positions_of(run.estimate, {}), truth, run.view);
  if (html.empty()) return {};
  html += R"(<p class="soft"><span class="estimate">■</span> estimate)";
  html += truth.empty() ? "</p>\n" : R"( &nbsp; <span class="truth">■</span> ground truth, aligned rigidly</p>)";
  return section("Trajectory", html);
}

std::string error_section(const std::vector<eval::PosePair>& pairs) {
  if (pairs.empty()) return {};
  const geometry::Pose alignment = eval::align_positions(pairs);
  const Eigen::Matrix3d rotation = eval::align_rotations(pairs);
  TimeSeries positions, rotations;
  for (const eval::PosePair& pair : pairs) {
    positions.times.push_back(pair.time_s);
    positions.values.push_back(1000.0 * (alignment * pair.estimate.translation - pair.reference.translation).norm());
    const double angle = geometry::rotation_angle_between(pair.reference.rotation, rotation * pair.estimate.rotation);
    rotations.values.push_back(kDegrees * angle);
  }
  rotations.times = positions.times;
  return section("Errors over time",
                 "<div class=\"row\">\n" + plot_over_time(positions, "position error after rigid alignment, mm") +
                     plot_over_time(rotations, "rotation error after rotation alignment, degrees") + "</div>\n");
}

std::string graph_section(const RunResults& run) {
  Points keyframes;
  std::map<egraph::KeyframeId, std::size_t> index;
  for (const egraph::KeyframeNode& node : run.graph.keyframes) {
    index[node.id] = keyframes.size();
    keyframes.push_back(node.world_from_camera.translation);
  }
  if (keyframes.empty()) return {};
  std::vector<std::pair<std::size_t, std::size_t>> edges, covisible;
  for (const egraph::Edge& edge : run.graph.edges) edges.emplace_back(index[edge.first], index[edge.second]);
  for (const auto& edge : run.graph.covisibility) {
    if (edge.shared_features >= kMinShared) covisible.emplace_back(index[edge.first], index[edge.second]);
  }
  std::string html = "<div class=\"row\">\n";
  html += draw_graph(keyframes, edges, "var(--good)",
                     fmt::format("E-Graph: {} edges between {} keyframes over {} directions", edges.size(),
                                 keyframes.size(), run.graph.landmarks.size()),
                     run.view);
  html += draw_graph(keyframes, covisible, "var(--bad)",
                     fmt::format("covisibility: {} edges ({} or more shared features)", covisible.size(), kMinShared),
                     run.view);
  return section("Graphs", html.append("</div>\n"));
}

std::string mesh_section(const RunResults& run) {
  if (run.mesh_views.empty()) return {};
  std::string html = "<div class=\"row wide\">\n";
  for (const Picture& picture : run.mesh_views) {
    html += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", embedded_png(picture.png, picture.caption),
                        escape(picture.caption));
  }
  return section("Mesh", html.append("</div>\n"));
}

std::string service_section(const RunResults& run) {
  if (run.services.empty()) return {};
  std::vector<std::vector<std::string>> rows;
  for (const ServiceSummary& service : run.services) {
    const auto frames = static_cast<double>(service.frames);
    rows.push_back({escape(service.name), fmt::format("{}", service.frames), fmt::format("{}", service.dropped),
                    fmt::format("{}", service.rejected), fmt::format("{:.1f}", service.latency_p50_ms),
                    fmt::format("{:.1f}", service.latency_p90_ms), fmt::format("{:.1f}", service.latency_p99_ms),
                    fmt::format("{:.1f}", service.latency_max_ms), fmt::format("{:.1f}", service.cpu_seconds),
                    frames > 0.0 ? fmt::format("{:.1f}", 1000.0 * service.cpu_seconds / frames) : std::string("–"),
                    fmt::format("{:.0f}", static_cast<double>(service.peak_memory_bytes) / kMegabyte)});
  }
  return section("Services", table({"service", "messages", "dropped", "refused", "p50 ms", "p90 ms", "p99 ms", "max ms",
                                    "CPU s", "CPU ms each", "peak MB"},
                                   rows));
}

}  // namespace

std::string write_report(const RunResults& run) {
  const auto pairs = eval::match_by_time(run.estimate, run.truth, eval::TrajectoryErrorOptions{}.max_time_difference_s);
  std::optional<eval::TrajectoryErrors> errors;
  if (const auto evaluated = eval::evaluate_trajectory(run.estimate, run.truth)) errors = *evaluated;
  const bool good = run.outcome == "complete";
  std::string html = fmt::format("<h1>E-Graph SLAM: {}</h1>\n<p class=\"{}\">{}</p>\n", escape(run.input),
                                 good ? "soft" : "bad", escape(run.outcome));
  html += tiles(run, errors);
  html += trajectory_section(run, pairs);
  html += error_section(pairs);
  if (!run.states.empty()) html += section("Tracking", plot_states(run.states));
  html += mesh_section(run);
  html += graph_section(run);
  html += service_section(run);
  if (!run.settings.empty()) html += section("Settings", fmt::format("<pre>{}</pre>\n", escape(run.settings)));
  return page(fmt::format("E-Graph SLAM: {}", run.input), html);
}

}  // namespace eg::report
