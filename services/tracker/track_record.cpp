#include "services/tracker/track_record.hpp"

#include <algorithm>
#include <string>

#include "common/io/atomic_file.hpp"
#include "common/io/number_format.hpp"
#include "common/io/ply.hpp"
#include "common/io/trajectory_file.hpp"

namespace eg::services {
namespace {

double seconds(std::int64_t utime) { return static_cast<double>(utime) * 1e-6; }

/// A text as one field of a CSV file (RFC 4180).
std::string quoted(const std::string& text) {
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? "\"\"" : std::string(1, c);
  return field + "\"";
}

std::string state_row(const tracking::PoseEstimate& estimate) {
  const auto id = [](tracking::KeyframeId keyframe) {
    return keyframe.valid() ? std::to_string(keyframe.value) : std::string();
  };
  return std::to_string(estimate.header.sequence) + "," + io::format_fixed(seconds(estimate.header.utime), 6) + "," +
         tracking::to_string(estimate.state) + "," + quoted(estimate.reason) + "," + id(estimate.keyframe) + "," +
         id(estimate.rotation_reference) + "," + std::to_string(estimate.matched_points) + "," +
         std::to_string(estimate.matched_lines) + "," + std::to_string(estimate.matched_planes) + "," +
         std::to_string(estimate.matched_directions) + "\n";
}

std::vector<io::ColouredPoint> living_points(const tracking::Map& map) {
  constexpr mapping::Colour kPointColour = {230, 230, 230};
  constexpr mapping::Colour kLineColour = {80, 160, 255};
  constexpr double kLineSpacing = 0.02;  // metres between the points that draw a segment
  std::vector<io::ColouredPoint> cloud;
  for (const tracking::MapPoint& point : map.points()) {
    if (point.alive && point.observations > 1) cloud.push_back({point.position.cast<float>(), kPointColour});
  }
  for (const tracking::MapLine& line : map.lines()) {
    if (!line.alive || line.observations < 2) continue;
    const int steps = std::max(1, static_cast<int>((line.end - line.start).norm() / kLineSpacing));
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector3d point = line.start + (line.end - line.start) * i / steps;
      cloud.push_back({point.cast<float>(), kLineColour});
    }
  }
  return cloud;
}

std::vector<geometry::StampedPose> keyframe_poses(const tracking::Map& map) {
  std::vector<geometry::StampedPose> poses;
  for (const tracking::MapKeyframe& keyframe : map.keyframes()) {
    poses.push_back({seconds(keyframe.features.header.utime), keyframe.world_from_camera});
  }
  return poses;
}

}  // namespace

void TrackRecord::add(const tracking::PoseEstimate& estimate, const tracking::Map& map) {
  Row row{estimate, {}, {}};
  if (estimate.has_pose) {
    const tracking::MapKeyframe& reference = map.keyframes().back();
    row.reference = reference.id;
    row.reference_from_camera = reference.world_from_camera.inverse() * estimate.world_from_camera;
  }
  rows_.push_back(std::move(row));
}

base::Status TrackRecord::save(const std::filesystem::path& folder, const tracking::Map& map) const {
  if (const auto written = save_trajectory(folder / "trajectory.txt", map); !written) return written;
  if (const auto written = save_states(folder / "states.csv"); !written) return written;
  if (const auto written = io::write_trajectory(folder / "keyframes.txt", keyframe_poses(map)); !written)
    return written;
  return io::write_point_cloud(folder / "map.ply", living_points(map));
}

base::Status TrackRecord::save_trajectory(const std::filesystem::path& path, const tracking::Map& map) const {
  std::vector<geometry::StampedPose> trajectory;
  for (const Row& row : rows_) {
    if (!row.estimate.has_pose) continue;
    const geometry::Pose& reference = map.keyframe(row.reference).world_from_camera;
    trajectory.push_back({seconds(row.estimate.header.utime), reference * row.reference_from_camera});
  }
  return io::write_trajectory(path, trajectory);
}

base::Status TrackRecord::save_states(const std::filesystem::path& path) const {
  std::vector<std::pair<std::int64_t, std::string>> rows;
  for (const Row& row : rows_) rows.emplace_back(row.estimate.header.utime, state_row(row.estimate));
  for (const std::int64_t utime : skipped_utimes_) {
    rows.emplace_back(utime,
                      "," + io::format_fixed(seconds(utime), 6) + ",skipped,\"image could not be read\",,,0,0,0,0\n");
  }
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string text = "sequence,time_s,state,reason,keyframe,rotation_reference,points,lines,planes,directions\n";
  for (const auto& [utime, row] : rows) text += row;
  return io::write_file_atomically(path, text);
}

}  // namespace eg::services
