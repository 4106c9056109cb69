#include "common/io/trajectory_file.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/io/atomic_file.hpp"
#include "common/io/number_format.hpp"
#include "common/io/text_file.hpp"
#include "common/io/time_stamp.hpp"

namespace eg::io {
namespace {

constexpr std::size_t kFields = 8;
// Files give quaternions with four or more digits.
constexpr double kQuaternionNormTolerance = 0.01;

struct Row {
  int line = 0;
  TimeStamp stamp;
  geometry::Pose pose;
};

base::Result<Row> parse_row(const std::filesystem::path& path, const TextLine& line) {
  const auto fields = split_fields(line.text);
  if (fields.size() != kFields) {
    return base::fail(
        located(path, line.number, "expected 'time tx ty tz qx qy qz qw', found " + in_quotes(line.text)));
  }
  const auto stamp = parse_time_stamp(fields[0]);
  if (!stamp) return base::fail(located(path, line.number, in_quotes(fields[0]) + " is not a time stamp in seconds"));
  std::array<double, kFields> values{};
  for (std::size_t i = 1; i < kFields; ++i) {
    const auto value = parse_number(fields[i]);
    if (!value) return base::fail(located(path, line.number, in_quotes(fields[i]) + " is not a number"));
    values[i] = *value;
  }
  const Eigen::Quaterniond quaternion(values[7], values[4], values[5], values[6]);
  if (std::abs(quaternion.norm() - 1.0) > kQuaternionNormTolerance) {
    return base::fail(
        located(path, line.number, "the quaternion's norm is " + format_significant(quaternion.norm(), 6) + ", not 1"));
  }
  return Row{line.number, *stamp, {quaternion.normalized().toRotationMatrix(), {values[1], values[2], values[3]}}};
}

base::Result<std::vector<Row>> parse_rows(const std::filesystem::path& path, std::string_view text) {
  std::vector<Row> rows;
  for (const TextLine& line : content_lines(text)) {
    const auto row = parse_row(path, line);
    if (!row) return tl::make_unexpected(row.error());
    if (!rows.empty() && row->stamp.value <= rows.back().stamp.value) {
      return base::fail(
          located(path, row->line, "time stamp is not later than that of line " + std::to_string(rows.back().line)));
    }
    rows.push_back(*row);
  }
  if (rows.empty()) return base::fail(path.string() + ": holds no pose");
  return rows;
}

}  // namespace

base::Result<std::vector<geometry::StampedPose>> read_trajectory(const std::filesystem::path& path,
                                                                 const TrajectoryOptions& options) {
  const auto text = read_file(path);
  if (!text) return tl::make_unexpected(text.error());
  const auto rows = parse_rows(path, *text);
  if (!rows) return tl::make_unexpected(rows.error());
  const bool counts_images =
      std::all_of(rows->begin(), rows->end(), [](const Row& row) { return row.stamp.maybe_index; });
  const double seconds_per_unit = counts_images ? 1.0 / options.index_rate : 1.0;
  std::vector<geometry::StampedPose> trajectory;
  for (const Row& row : *rows) trajectory.push_back({row.stamp.value * seconds_per_unit, row.pose});
  return trajectory;
}

std::string format_trajectory(std::span<const geometry::StampedPose> trajectory) {
  constexpr int kTimeDecimals = 6;
  constexpr int kDigits = 9;
  std::string text = "# time tx ty tz qx qy qz qw (camera to world)\n";
  for (const auto& [time_s, pose] : trajectory) {
    Eigen::Quaterniond q(pose.rotation);
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    text += format_fixed(time_s, kTimeDecimals);
    const Eigen::Vector3d& t = pose.translation;
    for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
      text += ' ' + format_significant(value, kDigits);
    }
    text += '\n';
  }
  return text;
}

base::Status write_trajectory(const std::filesystem::path& path, std::span<const geometry::StampedPose> trajectory) {
  return write_file_atomically(path, format_trajectory(trajectory));
}

}  // namespace eg::io
