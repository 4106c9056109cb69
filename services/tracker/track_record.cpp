#include "services/tracker/track_record.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "common/io/atomic_file.hpp"
#include "common/io/number_format.hpp"
#include "common/io/pcd.hpp"
#include "common/io/trajectory_file.hpp"

namespace eg::services {
namespace {

/// Dropped frames in a row that are listed one by one: numbers come from the bus and must not size an allocation.
constexpr std::int64_t kMaxGap = 100'000;

double seconds(std::int64_t utime) { return static_cast<double>(utime) * 1e-6; }

/// A text as one field of a CSV file (RFC 4180).
std::string in_quotes(const std::string& text) {
  std::string field(1, '"');
  for (const char c : text) {
    if (c == '"') field.push_back(c);
    field.push_back(c);
  }
  field.push_back('"');
  return field;
}

std::string join(const std::vector<std::string>& fields) {
  std::string row;
  for (const std::string& field : fields) {
    if (&field != &fields.front()) row.push_back(',');
    row.append(field);
  }
  row.push_back('\n');
  return row;
}

std::string id_field(tracking::KeyframeId id) { return id.valid() ? std::to_string(id.value) : std::string(); }

std::string skipped_row(std::int64_t utime) {
  return join({"", io::format_fixed(seconds(utime), 6), "skipped", in_quotes("image could not be read"), "", "", "0",
               "0", "0", "0"});
}

std::string dropped_row(std::int64_t sequence) {
  return join({std::to_string(sequence), "", "dropped", in_quotes("its features did not arrive in time"), "", "", "0",
               "0", "0", "0"});
}

/// Points as vertices, lines as edges between two of them: what was seen from two keyframes or more.
io::PlyData sparse_map(const tracking::Map& map) {
  constexpr mapping::Colour kPointColour = {230, 230, 230};
  constexpr mapping::Colour kLineColour = {80, 160, 255};
  io::PlyData ply;
  const auto add = [&ply](const Eigen::Vector3d& position, const mapping::Colour& colour) {
    ply.vertices.push_back(position.cast<float>());
    ply.colours.push_back(colour);
  };
  for (const tracking::MapPoint& point : map.points()) {
    if (point.alive && point.observations > 1) add(point.position, kPointColour);
  }
  for (const tracking::MapLine& line : map.lines()) {
    if (!line.alive || line.observations < 2) continue;
    const auto first = static_cast<std::uint32_t>(ply.vertices.size());
    add(line.start, kLineColour);
    add(line.end, kLineColour);
    ply.edges.push_back({first, first + 1});
  }
  return ply;
}

/// After a clock was set back times come again: of two poses with the same time the newer is kept.
std::vector<geometry::StampedPose> in_order_of_time(std::vector<geometry::StampedPose> poses) {
  std::reverse(poses.begin(), poses.end());
  std::stable_sort(poses.begin(), poses.end(), [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  const auto same = [](const auto& a, const auto& b) { return a.time_s == b.time_s; };
  poses.erase(std::unique(poses.begin(), poses.end(), same), poses.end());
  return poses;
}

std::vector<geometry::StampedPose> keyframe_poses(std::span<const tracking::MapKeyframe> keyframes) {
  std::vector<geometry::StampedPose> poses;
  for (const tracking::MapKeyframe& keyframe : keyframes) {
    poses.push_back({seconds(keyframe.features.header.utime), keyframe.world_from_camera});
  }
  return in_order_of_time(std::move(poses));
}

}  // namespace

void TrackRecord::add(const tracking::PoseEstimate& estimate, const tracking::Map& map) {
  Row row;
  row.sequence = estimate.header.sequence;
  row.utime = estimate.header.utime;
  row.state = estimate.state;
  row.reason = number_of(estimate.reason);
  row.keyframe = estimate.keyframe;
  row.rotation_reference = estimate.rotation_reference;
  row.points = estimate.matched_points;
  row.lines = estimate.matched_lines;
  row.planes = estimate.matched_planes;
  row.directions = estimate.matched_directions;
  if (estimate.has_pose) {
    const tracking::MapKeyframe& reference = map.keyframes().back();
    row.reference = reference.id;
    row.reference_from_camera = reference.world_from_camera.inverse() * estimate.world_from_camera;
  }
  rows_.push_back(row);
}

std::uint32_t TrackRecord::number_of(const std::string& reason) {
  const auto [known, is_new] = reason_numbers_.try_emplace(reason, static_cast<std::uint32_t>(reasons_.size()));
  if (is_new) reasons_.push_back(reason);
  return known->second;
}

std::string TrackRecord::state_row(const Row& row) const {
  return join({std::to_string(row.sequence), io::format_fixed(seconds(row.utime), 6), tracking::to_string(row.state),
               in_quotes(reasons_[row.reason]), id_field(row.keyframe), id_field(row.rotation_reference),
               std::to_string(row.points), std::to_string(row.lines), std::to_string(row.planes),
               std::to_string(row.directions)});
}

base::Status TrackRecord::save(const std::filesystem::path& folder, const tracking::Map& map) const {
  if (const auto written = save_trajectory(folder / "trajectory.txt", map); !written) return written;
  if (const auto written = save_states(folder / "states.csv"); !written) return written;
  if (const auto written =
          io::write_trajectory(folder / "keyframes.txt", keyframe_poses(map.keyframes().subspan(earlier_keyframes_)));
      !written)
    return written;
  const io::PlyData landmarks = sparse_map(map);
  if (const auto written = io::write_ply(folder / "map.ply", io::view_of(landmarks)); !written) return written;
  return io::write_pcd(folder / "map.pcd", io::view_of(landmarks));
}

base::Status TrackRecord::save_trajectory(const std::filesystem::path& path, const tracking::Map& map) const {
  std::vector<geometry::StampedPose> trajectory;
  for (const Row& row : rows_) {
    if (!row.reference.valid()) continue;
    const geometry::Pose& reference = map.keyframe(row.reference).world_from_camera;
    trajectory.push_back({seconds(row.utime), reference * row.reference_from_camera});
  }
  return io::write_trajectory(path, in_order_of_time(std::move(trajectory)));
}

base::Status TrackRecord::save_states(const std::filesystem::path& path) const {
  std::vector<std::pair<std::int64_t, std::string>> rows;  // by time; a frame that never came has its predecessor's
  std::int64_t expected = 0;
  std::int64_t last_utime = 0;
  for (const Row& row : rows_) {
    for (expected = std::max(expected, row.sequence - kMaxGap); expected < row.sequence; ++expected) {
      rows.emplace_back(last_utime, dropped_row(expected));
    }
    rows.emplace_back(row.utime, state_row(row));
    expected = row.sequence + 1;
    last_utime = row.utime;
  }
  for (expected = std::max(expected, frame_count_ - kMaxGap); expected < frame_count_; ++expected) {
    rows.emplace_back(last_utime, dropped_row(expected));
  }
  for (const std::int64_t utime : skipped_utimes_) rows.emplace_back(utime, skipped_row(utime));
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string text = "sequence,time_s,state,reason,keyframe,rotation_reference,points,lines,planes,directions\n";
  for (const auto& [utime, row] : rows) text += row;
  return io::write_file_atomically(path, text);
}

}  // namespace eg::services
