#include "common/eval/report.hpp"

#include <iomanip>
#include <locale>
#include <sstream>

namespace eg::eval {
namespace {

constexpr int kLabelWidth = 36;
constexpr int kColumnWidth = 10;

std::string fixed(double value, int decimals) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

std::string percent(double share) { return fixed(100.0 * share, 1) + " %"; }

std::string label(const std::string& text) {
  std::ostringstream padded;
  padded << std::left << std::setw(kLabelWidth) << text;
  return padded.str();
}

std::string column(const std::string& text) {
  std::ostringstream padded;
  padded << std::right << std::setw(kColumnWidth) << text;
  return padded.str();
}

std::string heading() {
  std::string text = label("");
  for (const char* name : {"RMSE", "mean", "median", "95 %", "max", "count"}) text += column(name);
  return text + "\n";
}

std::string row(const char* name, const ErrorStatistics& s) {
  std::string text = label(name);
  if (s.count == 0) return text + column("none") + "\n";
  for (const double value : {s.rmse, s.mean, s.median, s.p95, s.max}) text += column(fixed(value, 4));
  return text + column(std::to_string(s.count)) + "\n";
}

std::string shares(const char* name, const SurfaceDistances& distances) {
  return label(name) + column(percent(distances.share_within_1cm)) + column(percent(distances.share_within_5cm)) + "\n";
}

}  // namespace

std::string table_of(const TrajectoryErrors& errors) {
  return std::to_string(errors.matched_poses) + " of " + std::to_string(errors.estimated_poses) +
         " estimated poses matched, " + percent(errors.coverage) + " of the reference's time covered\n" + heading() +
         row("ATE, rigid alignment (m)", errors.ate_m) + row("ARE, rotation alignment (deg)", errors.are_aligned_deg) +
         row("ARE, first pose alignment (deg)", errors.are_first_pose_deg) +
         row("RPE over 1 s, translation (m)", errors.rpe_translation_m) +
         row("RPE over 1 s, rotation (deg)", errors.rpe_rotation_deg);
}

std::string table_of(const Drift& drift) {
  return fixed(drift.duration_s, 1) + " s, " + fixed(drift.path_m, 1) + " m of way, position off by " +
         fixed(drift.end_error_m, 3) + " m at its end\nrotation error grows by " +
         fixed(drift.rotation_slope_deg_per_min, 4) + " +- " + fixed(drift.rotation_slope_sigma, 4) +
         " deg per minute, from " + fixed(drift.rotation_start_deg, 3) + " to " + fixed(drift.rotation_end_deg, 3) +
         " deg\n" + heading() + row("position drift (m per m)", drift.position_per_m) +
         row("rotation drift (deg per m)", drift.rotation_deg_per_m);
}

std::string table_of(const GraphErrors& errors) {
  return std::to_string(errors.keyframes) + " keyframes, " + std::to_string(errors.edges) + " edges, " +
         std::to_string(errors.edges_without_reference) + " of them without a reference pose\n" +
         "rotation error of edges (deg)\n" + heading() + row("all edges", errors.all_deg) +
         row("between overlapping views", errors.overlapping_deg) +
         row("between views without overlap", errors.non_overlapping_deg);
}

std::string table_of(const MeshErrors& errors) {
  return "distance (m), weighted by area\n" + heading() +
         row("accuracy, estimate to reference", errors.accuracy.distance_m) +
         row("completeness, reference to estimate", errors.completeness.distance_m) + label("") + column("1 cm") +
         column("5 cm") + "\n" + shares("share of the estimate within", errors.accuracy) +
         shares("share of the reference within", errors.completeness);
}

}  // namespace eg::eval
