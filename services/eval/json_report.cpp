#include "services/eval/json_report.hpp"

namespace eg::service {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const eval::ErrorStatistics& s) {
  if (s.count == 0) return nullptr;
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median}, {"p95", s.p95}, {"max", s.max}, {"count", s.count}};
}

/// One figure of the statistics, or null if they are of nothing.
Json figure(const eval::ErrorStatistics& s, double eval::ErrorStatistics::*which) {
  return s.count == 0 ? Json(nullptr) : Json(s.*which);
}

Json json_of(const eval::SurfaceDistances& distances) {
  return {{"distance_m", json_of(distances.distance_m)},
          {"share_within_1cm", distances.share_within_1cm},
          {"share_within_5cm", distances.share_within_5cm}};
}

}  // namespace

Json json_of(const eval::TrajectoryErrors& errors) {
  using Statistics = eval::ErrorStatistics;
  return {{"ate_rmse_m", figure(errors.ate_m, &Statistics::rmse)},
          {"are_mean_deg", figure(errors.are_aligned_deg, &Statistics::mean)},
          {"are_first_pose_mean_deg", figure(errors.are_first_pose_deg, &Statistics::mean)},
          {"rpe_translation_rmse_m", figure(errors.rpe_translation_m, &Statistics::rmse)},
          {"rpe_rotation_rmse_deg", figure(errors.rpe_rotation_deg, &Statistics::rmse)},
          {"matched_frames", errors.matched_poses},
          {"estimated_frames", errors.estimated_poses},
          {"reference_poses", errors.reference_poses},
          {"coverage", errors.coverage},
          {"ate_m", json_of(errors.ate_m)},
          {"are_aligned_deg", json_of(errors.are_aligned_deg)},
          {"are_first_pose_deg", json_of(errors.are_first_pose_deg)},
          {"rpe_translation_m", json_of(errors.rpe_translation_m)},
          {"rpe_rotation_deg", json_of(errors.rpe_rotation_deg)}};
}

Json json_of(const eval::Drift& drift) {
  return {{"rotation_slope_deg_per_min", drift.rotation_slope_deg_per_min},
          {"rotation_slope_sigma", drift.rotation_slope_sigma},
          {"rotation_start_deg", drift.rotation_start_deg},
          {"rotation_end_deg", drift.rotation_end_deg},
          {"duration_s", drift.duration_s},
          {"path_m", drift.path_m},
          {"end_error_m", drift.end_error_m},
          {"position_per_m", json_of(drift.position_per_m)},
          {"rotation_deg_per_m", json_of(drift.rotation_deg_per_m)}};
}

Json json_of(const eval::GraphErrors& errors) {
  using Statistics = eval::ErrorStatistics;
  return {{"edge_rotation_mean_deg", figure(errors.all_deg, &Statistics::mean)},
          {"keyframes", errors.keyframes},
          {"edges", errors.edges},
          {"edges_without_reference", errors.edges_without_reference},
          {"all_deg", json_of(errors.all_deg)},
          {"overlapping_deg", json_of(errors.overlapping_deg)},
          {"non_overlapping_deg", json_of(errors.non_overlapping_deg)}};
}

Json json_of(const eval::MeshErrors& errors) {
  using Statistics = eval::ErrorStatistics;
  return {{"accuracy_mean_m", figure(errors.accuracy.distance_m, &Statistics::mean)},
          {"completeness_mean_m", figure(errors.completeness.distance_m, &Statistics::mean)},
          {"accuracy", json_of(errors.accuracy)},
          {"completeness", json_of(errors.completeness)}};
}

}  // namespace eg::service
