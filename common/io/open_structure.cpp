#include "common/io/open_structure.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "common/features/features.hpp"
#include "common/io/text_file.hpp"
#include "common/io/trajectory_file.hpp"

namespace eg::io {
namespace {

namespace fs = std::filesystem;
using Fields = std::vector<std::string_view>;
using Id = std::int32_t;
using observations::RecordedFrame;
using observations::Recording;

constexpr double kFrameRate = 30.0;  // of the format
constexpr double kSameFrame = 0.01;  // frames: how exactly times in seconds must agree with that

std::optional<Id> parse_id(std::string_view text) {
  const auto value = parse_integer(text);
  if (!value || *value < 0 || *value > INT32_MAX) return std::nullopt;
  return static_cast<Id>(*value);
}

/// The numbers from field `first` on, exactly `Count` of them.
template <std::size_t Count>
std::optional<std::array<double, Count>> parse_numbers(const Fields& fields, std::size_t first) {
  if (fields.size() != first + Count) return std::nullopt;
  std::array<double, Count> values{};
  for (std::size_t i = 0; i < Count; ++i) {
    const auto value = parse_number(fields[first + i]);
    if (!value) return std::nullopt;
    values[i] = *value;
  }
  return values;
}

base::Result<std::vector<RecordedFrame>> read_frames(const fs::path& file) {
  const auto poses = read_trajectory(file, {.index_rate = kFrameRate});
  if (!poses) return tl::make_unexpected(poses.error());
  std::vector<RecordedFrame> frames;
  for (const geometry::StampedPose& stamped : *poses) {
    if (std::abs(stamped.time_s * kFrameRate - static_cast<double>(frames.size())) > kSameFrame) {
      return base::fail(file.string() + ": frames are not numbered 0, 1, 2, ...: after frame " +
                        std::to_string(frames.size()) + " poses comes another number");
    }
    frames.push_back({stamped.time_s, stamped.world_from_camera, {}, {}});
  }
  return frames;
}

base::Result<std::map<Id, Eigen::Vector3d>> read_landmarks(const fs::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::make_unexpected(text.error());
  std::map<Id, Eigen::Vector3d> landmarks;
  for (const TextLine& line : content_lines(*text)) {
    const Fields fields = split_fields(line.text);
    const auto id = parse_id(fields[0]);
    const auto position = parse_numbers<3>(fields, 1);
    if (!id || !position) {
      return base::fail(located(file, line.number, "expected 'point x y z', found " + in_quotes(line.text)));
    }
    if (!landmarks.emplace(*id, Eigen::Vector3d(position->data())).second) {
      return base::fail(located(file, line.number, "point " + std::to_string(*id) + " is there twice"));
    }
  }
  return landmarks;
}

/// Takes venom_sequence.txt into a recording line by line. Each add function gives what is wrong with the line, or "".
class SequenceReader {
 public:
  SequenceReader(Recording& recording, const std::map<Id, Eigen::Vector3d>& landmarks)
      : recording_(recording), landmarks_(landmarks), seen_points_(size()), seen_lines_(size()) {}

  std::string add(const TextLine& line) {
    const Fields fields = split_fields(line.text);
    const std::string_view keyword = fields[0];
    if (keyword == "MappointFrameAsso:") return add_point(fields);
    if (keyword == "MaplineFrameAsso:") return add_line(fields);
    if (keyword == "ParalineMaplineAsso:") return add_group(fields);
    if (keyword == "Vertex:" || keyword == "Mappoint:" || keyword == "Mapline:") return "";
    return in_quotes(keyword) + " is no keyword of the format";
  }

 private:
  [[nodiscard]] std::size_t size() const { return recording_.frames.size(); }

  std::string add_point(const Fields& fields) {
    const auto pixel = parse_numbers<2>(fields, 3);
    const auto id = pixel ? parse_id(fields[1]) : std::nullopt;
    const auto frame = pixel ? parse_id(fields[2]) : std::nullopt;
    if (!id || !frame) return "expected 'MappointFrameAsso: point frame u v'";
    if (static_cast<std::size_t>(*frame) >= size()) return unknown_frame(*frame);
    const auto landmark = landmarks_.find(*id);
    if (landmark == landmarks_.end()) return "point " + std::to_string(*id) + " has no position";
    auto& known = seen_points_[static_cast<std::size_t>(*frame)];
    if (!known.insert(*id).second) return twice("point", *id, *frame);
    if (known.size() > features::kMaxPoints) return too_many("points", features::kMaxPoints, *frame);

    RecordedFrame& into = recording_.frames[static_cast<std::size_t>(*frame)];
    const double depth = (into.world_from_camera.inverse() * landmark->second).z();
    if (depth <= 0.0)
      return "point " + std::to_string(*id) + " is behind the camera of frame " + std::to_string(*frame);
    into.points.push_back({*id, Eigen::Vector2d(pixel->data()), depth});
    return "";
  }

  std::string add_line(const Fields& fields) {
    const auto ends = parse_numbers<6>(fields, 3);
    const auto id = ends ? parse_id(fields[1]) : std::nullopt;
    const auto frame = ends ? parse_id(fields[2]) : std::nullopt;
    if (!id || !frame) return "expected 'MaplineFrameAsso: line frame u1 v1 depth1 u2 v2 depth2'";
    if (static_cast<std::size_t>(*frame) >= size()) return unknown_frame(*frame);
    auto& known = seen_lines_[static_cast<std::size_t>(*frame)];
    if (!known.insert(*id).second) return twice("line", *id, *frame);
    if (known.size() > features::kMaxLines) return too_many("lines", features::kMaxLines, *frame);

    const auto& [u1, v1, depth1, u2, v2, depth2] = *ends;
    recording_.frames[static_cast<std::size_t>(*frame)].lines.push_back({*id, {u1, v1}, {u2, v2}, depth1, depth2});
    return "";
  }

  std::string add_group(const Fields& fields) {
    static constexpr const char* kForm = "expected 'ParalineMaplineAsso: group count line line ...'";
    const auto group = fields.size() > 2 ? parse_id(fields[1]) : std::nullopt;
    const auto count = fields.size() > 2 ? parse_id(fields[2]) : std::nullopt;
    if (!group || !count) return kForm;
    if (static_cast<std::size_t>(*count) != fields.size() - 3) {
      return "the group has " + std::to_string(fields.size() - 3) + " lines, not " + std::to_string(*count);
    }
    for (std::size_t i = 3; i < fields.size(); ++i) {
      const auto line = parse_id(fields[i]);
      if (!line) return kForm;
      const auto [known, is_new] = recording_.line_groups.emplace(*line, *group);
      if (!is_new)
        return "line " + std::to_string(*line) + " is in group " + std::to_string(known->second) + " already";
    }
    return "";
  }

  [[nodiscard]] std::string unknown_frame(Id frame) const {
    return "frame " + std::to_string(frame) + " has no pose: there are " + std::to_string(size());
  }
  static std::string twice(const char* what, Id id, Id frame) {
    return std::string(what) + " " + std::to_string(id) + " is observed twice in frame " + std::to_string(frame);
  }
  static std::string too_many(const char* what, int limit, Id frame) {
    return "more than " + std::to_string(limit) + " " + what + " in frame " + std::to_string(frame);
  }

  Recording& recording_;
  const std::map<Id, Eigen::Vector3d>& landmarks_;
  std::vector<std::set<Id>> seen_points_, seen_lines_;  // by frame
};

}  // namespace

base::Result<Recording> read_open_structure(const fs::path& folder) {
  auto frames = read_frames(folder / "ground_truth.txt");
  if (!frames) return tl::make_unexpected(frames.error());
  const auto landmarks = read_landmarks(folder / "point_landmarks.txt");
  if (!landmarks) return tl::make_unexpected(landmarks.error());
  const fs::path file = folder / "venom_sequence.txt";
  const auto text = read_file(file);
  if (!text) return tl::make_unexpected(text.error());

  Recording recording{*std::move(frames), {}};
  SequenceReader reader(recording, *landmarks);
  for (const TextLine& line : content_lines(*text)) {
    if (const std::string wrong = reader.add(line); !wrong.empty())
      return base::fail(located(file, line.number, wrong));
  }
  return recording;
}

}  // namespace eg::io
