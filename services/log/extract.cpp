#include "services/log/extract.hpp"

#include <spdlog/fmt/fmt.h>

#include <map>
#include <vector>

#include "common/io/atomic_file.hpp"
#include "common/io/camera_file.hpp"
#include "common/io/image_file.hpp"
#include "common/io/trajectory_file.hpp"
#include "common/messages/channels.hpp"
#include "common/service/message_records.hpp"
#include "common/transport/event_log.hpp"

namespace eg::log_tool {
namespace {

constexpr double kSeconds = 1e-6;  // per microsecond

/// Every valid message of type T on a channel, by its frame's sequence number; of repeated ones the last. Messages of
/// sessions that are not selected are left out; an error if that leaves it open which session is meant.
template <typename T>
base::Result<std::map<std::int64_t, T>> read_messages(const std::filesystem::path& log, const Selection& selection,
                                                      const char* channel) {
  auto reader = transport::EventLogReader::open(log);
  if (!reader) return tl::make_unexpected(reader.error());
  std::map<std::int64_t, T> values;
  std::optional<std::int64_t> session = selection.session;
  for (;;) {
    const auto event = reader->next();
    if (!event && reader->recover() > 0) continue;
    if (!event || !*event) break;
    if ((*event)->channel != selection.channel_prefix + channel) continue;
    auto value = messages::decode<T>((*event)->bytes);
    if (!value) continue;
    if (!session) session = value->header.session;
    if (value->header.session == *session) {
      values.insert_or_assign(value->header.sequence, *std::move(value));
    } else if (!selection.session) {
      return base::fail("the log " + log.string() + " holds sessions " + std::to_string(*session) + " and " +
                        std::to_string(value->header.session) + " on channel " + channel + ": choose with --session");
    }
  }
  if (values.empty()) return base::fail("the log " + log.string() + " holds no messages on channel " + channel);
  return values;
}

/// Appends a frame's features as lines of text; returns how many.
std::int64_t append(const features::FrameFeatures& frame, std::string& text) {
  const std::string head = fmt::format("{},{},", frame.header.sequence, frame.header.utime);
  for (const auto& point : frame.points) {
    text += fmt::format("{}point,{},{},{}\n", head, point.pixel.x(), point.pixel.y(), point.depth);
  }
  for (const auto& line : frame.lines) {
    text += fmt::format("{}line,{},{},{},{}\n", head, line.start_pixel.x(), line.start_pixel.y(), line.end_pixel.x(),
                        line.end_pixel.y());
  }
  for (const auto& plane : frame.planes) {
    const Eigen::Vector3d& normal = plane.plane.normal;
    text += fmt::format("{}plane,{},{},{},{}\n", head, normal.x(), normal.y(), normal.z(), plane.plane.distance);
  }
  for (const auto& direction : frame.directions) {
    const Eigen::Vector3d& unit = direction.direction;
    text +=
        fmt::format("{}direction,{},{},{},{}\n", head, unit.x(), unit.y(), unit.z(), static_cast<int>(direction.kind));
  }
  return static_cast<std::int64_t>(frame.points.size() + frame.lines.size() + frame.planes.size() +
                                   frame.directions.size());
}

}  // namespace

base::Result<std::int64_t> extract_images(const std::filesystem::path& log, const Selection& selection,
                                          const std::filesystem::path& folder) {
  auto frames = recording::FrameLog::open(
      log, {selection.channel_prefix.empty() ? "" : selection.channel_prefix + messages::channels::kRgbd,
            selection.session});
  if (!frames) return tl::make_unexpected(frames.error());
  std::error_code failure;
  std::filesystem::create_directories(folder / "rgb", failure);
  if (!failure) std::filesystem::create_directories(folder / "depth", failure);
  if (failure) return base::fail("cannot make the folder " + folder.string() + ": " + failure.message());
  std::string colour_list = "# colour images\n";
  std::string depth_list = "# depth images\n";
  for (std::size_t i = 0; i < frames->frames().size(); ++i) {
    const auto frame = frames->read(i);
    if (!frame) return tl::make_unexpected(frame.error());
    const auto images = messages::decompress(*frame);
    if (!images) return tl::make_unexpected(images.error());
    const std::string time = fmt::format("{:.6f}", kSeconds * static_cast<double>(frame->header.utime));
    const std::string colour =
        "rgb/" + time + (frame->colour_encoding == codec::ColourEncoding::jpeg ? ".jpg" : ".png");
    const std::string depth = "depth/" + time + ".png";
    if (const auto written = io::write_file_atomically(folder / colour, service::text_of(frame->colour)); !written) {
      return tl::make_unexpected(written.error());
    }
    if (const auto written = io::write_png(folder / depth, images->depth); !written) {
      return tl::make_unexpected(written.error());
    }
    colour_list += fmt::format("{} {}\n", time, colour);
    depth_list += fmt::format("{} {}\n", time, depth);
  }
  auto written = io::write_file_atomically(folder / "rgb.txt", colour_list)
                     .and_then([&] { return io::write_file_atomically(folder / "depth.txt", depth_list); })
                     .and_then([&] { return io::write_camera(folder / "camera.yaml", frames->camera()); });
  if (!written) return tl::make_unexpected(written.error());
  return static_cast<std::int64_t>(frames->frames().size());
}

base::Result<std::int64_t> extract_poses(const std::filesystem::path& log, const Selection& selection,
                                         const std::filesystem::path& file) {
  const auto estimates = read_messages<tracking::PoseEstimate>(log, selection, messages::channels::kPose);
  if (!estimates) return tl::make_unexpected(estimates.error());
  std::vector<geometry::StampedPose> poses;
  for (const auto& [sequence, estimate] : *estimates) {
    const double time_s = kSeconds * static_cast<double>(estimate.header.utime);
    if (estimate.has_pose) poses.push_back({time_s, estimate.world_from_camera});
  }
  if (const auto written = io::write_trajectory(file, poses); !written) return tl::make_unexpected(written.error());
  return static_cast<std::int64_t>(poses.size());
}

base::Result<std::int64_t> extract_features(const std::filesystem::path& log, const Selection& selection,
                                            const std::filesystem::path& file) {
  const auto frames = read_messages<features::FrameFeatures>(log, selection, messages::channels::kFeatures);
  if (!frames) return tl::make_unexpected(frames.error());
  std::string text =
      "# sequence,utime,kind and: point x,y pixels, depth metres; line x,y,x,y pixels; plane normal x,y,z and distance "
      "metres; direction x,y,z and 0 plane normal, 1 vanishing, 2 potential\n";
  std::int64_t count = 0;
  for (const auto& [sequence, frame] : *frames) count += append(frame, text);
  if (const auto written = io::write_file_atomically(file, text); !written) return tl::make_unexpected(written.error());
  return count;
}

}  // namespace eg::log_tool
