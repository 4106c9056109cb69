#include "services/run/report.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/io/atomic_file.hpp"
#include "common/io/trajectory_file.hpp"

namespace eg::run {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const messages::ServiceStatus& status) {
  return {{"state", status.state},
          {"host", status.host},
          {"frames", status.frames},
          {"dropped", status.dropped},
          {"rejected", status.rejected},
          {"last_rejection", status.last_rejection},
          {"latency_ms",
           {{"p50", status.latency_p50_ms},
            {"p90", status.latency_p90_ms},
            {"p99", status.latency_p99_ms},
            {"max", status.latency_max_ms}}},
          {"cpu_seconds", status.cpu_seconds},
          {"peak_memory_bytes", status.peak_memory_bytes}};
}

Json to_json(const eval::TrajectoryErrors& errors) {
  return {{"matched_poses", errors.matched_poses},
          {"ate_rmse_m", errors.ate_m.rmse},
          {"are_mean_deg", errors.are_aligned_deg.mean},
          {"are_first_pose_mean_deg", errors.are_first_pose_deg.mean},
          {"rpe_translation_rmse_m", errors.rpe_translation_m.rmse},
          {"rpe_rotation_rmse_deg", errors.rpe_rotation_deg.rmse}};
}

double frame_rate(const RunMonitor& monitor, const RunReport& report) {
  const auto intervals = static_cast<double>(monitor.frames_done() - 1);
  return report.processing_seconds > 0.0 ? intervals / report.processing_seconds : 0.0;
}

std::string list_files(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return fmt::format("{}", fmt::join(names, " "));
}

std::int64_t dropped(const RunMonitor& monitor) {
  std::int64_t sum = 0;
  for (const auto& [name, status] : monitor.statuses()) sum += status.dropped;
  return sum;
}

}  // namespace

base::Result<std::optional<eval::TrajectoryErrors>> evaluate(const std::filesystem::path& out, const Input& input) {
  const std::filesystem::path trajectory = out / "trajectory.txt";
  if (!std::filesystem::exists(trajectory) || !std::filesystem::exists(input.ground_truth)) return std::nullopt;
  const auto estimate = io::read_trajectory(trajectory);
  if (!estimate) return tl::make_unexpected(estimate.error());
  const auto reference = io::read_trajectory(input.ground_truth);
  if (!reference) return tl::make_unexpected(reference.error());
  return eval::evaluate_trajectory(*estimate, *reference).map([](const eval::TrajectoryErrors& errors) {
    return std::optional(errors);
  });
}

base::Status write_status(const std::filesystem::path& file, const RunOptions& options, const Input& input,
                          const RunMonitor& monitor, const RunReport& report) {
  Json json = {{"input", input.observations.empty() ? input.dataset : input.observations},
               {"depth_noise", options.depth_noise},
               {"mode", options.realtime ? "realtime" : "lockstep"},
               {"result", report.result},
               {"failure", report.failure},
               {"frames_expected", input.frames},
               {"frames_done", monitor.frames_done()},
               {"frames_skipped", monitor.frames_skipped()},
               {"frames_with_pose", monitor.poses()},
               {"keyframes", monitor.keyframes()},
               {"wall_seconds", report.wall_seconds},
               {"processing_seconds", report.processing_seconds},
               {"frames_per_second", frame_rate(monitor, report)}};
  if (report.errors) json["errors"] = to_json(*report.errors);
  for (const auto& [name, status] : monitor.statuses()) json["services"][name] = to_json(status);
  // Names of folders and reasons are any bytes: what is no UTF-8 is replaced.
  return io::write_file_atomically(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::string summarise(const std::filesystem::path& out, const RunMonitor& monitor, const RunReport& report) {
  std::string text = fmt::format(
      "{}: {} frames in {:.1f} s ({:.1f} frames/s), {} with a pose, {} keyframes, {} dropped, {} unreadable\n",
      report.result, monitor.frames_done(), report.wall_seconds, frame_rate(monitor, report), monitor.poses(),
      monitor.keyframes(), dropped(monitor), monitor.frames_skipped());
  if (report.errors) {
    const eval::TrajectoryErrors& errors = *report.errors;
    text += fmt::format(
        "errors against ground truth over {} poses: ATE {:.4f} m RMSE, ARE {:.3f} deg mean ({:.3f} from the first "
        "pose)",
        errors.matched_poses, errors.ate_m.rmse, errors.are_aligned_deg.mean, errors.are_first_pose_deg.mean);
    if (errors.rpe_translation_m.count > 0) {
      text += fmt::format(", RPE over 1 s {:.4f} m and {:.3f} deg RMSE", errors.rpe_translation_m.rmse,
                          errors.rpe_rotation_deg.rmse);
    }
    text += '\n';
  }
  return text + fmt::format("results in {}: {}", out.string(), list_files(out));
}

}  // namespace eg::run
