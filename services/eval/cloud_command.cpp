#include <optional>
#include <vector>

#include "common/eval/alignment.hpp"
#include "common/eval/depth_cloud.hpp"
#include "common/eval/trajectory_errors.hpp"
#include "common/image/rectifier.hpp"
#include "common/io/camera_file.hpp"
#include "common/io/dataset.hpp"
#include "common/io/ply.hpp"
#include "common/io/trajectory_file.hpp"
#include "services/eval/commands.hpp"

namespace eg::service {
namespace {

/// The true pose of each image, as far as there is one at its time.
std::vector<std::optional<geometry::Pose>> poses_of(const io::Dataset& dataset,
                                                    const std::vector<geometry::StampedPose>& truth) {
  std::vector<geometry::StampedPose> images;
  for (const io::DatasetFrame& frame : dataset.frames) images.push_back({frame.time_s, {}});
  const auto pairs = eval::match_by_time(images, truth, eval::TrajectoryErrorOptions{}.max_time_difference_s);
  std::vector<std::optional<geometry::Pose>> poses(images.size());
  auto pair = pairs.begin();
  for (std::size_t i = 0; i < images.size() && pair != pairs.end(); ++i) {
    if (pair->time_s == images[i].time_s) poses[i] = (pair++)->reference;
  }
  return poses;
}

}  // namespace

base::Result<Report> write_depth_cloud(const CloudSource& source, const eval::DepthCloudOptions& options,
                                       const std::filesystem::path& out) {
  const auto dataset = io::open_dataset(source.dataset);
  if (!dataset) return tl::make_unexpected(dataset.error());
  const auto camera = io::resolve_camera(
      source.dataset, source.camera.empty() ? std::nullopt : std::optional<std::string>(source.camera));
  if (!camera) return tl::make_unexpected(camera.error());
  const std::filesystem::path groundtruth = source.groundtruth.empty() ? dataset->ground_truth : source.groundtruth;
  if (groundtruth.empty()) return base::fail(source.dataset.string() + ": has no true poses; give --groundtruth");
  const auto truth = io::read_trajectory(groundtruth);
  if (!truth) return tl::make_unexpected(truth.error());

  eval::DepthCloud cloud(options);
  image::Rectifier rectifier;
  std::size_t used = 0;
  const auto poses = poses_of(*dataset, *truth);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i]) continue;
    const auto frame = io::read_frame(*dataset, i, camera->camera);
    if (!frame) return tl::make_unexpected(frame.error());
    cloud.add(rectifier.rectify(*frame), *poses[i]);
    ++used;
  }
  if (used == 0) return base::fail(groundtruth.string() + ": no pose is at the time of an image");
  if (const auto written = io::write_ply(out, {cloud.points(), {}, cloud.colours()}); !written) {
    return tl::make_unexpected(written.error());
  }
  const std::size_t points = cloud.points().size();
  const std::size_t frames = dataset->frames.size();
  return Report{out.string() + ": " + std::to_string(points) + " points of " + std::to_string(used) + " images (" +
                    std::to_string(frames - used) + " have no true pose)\n",
                {{"cloud", out.string()}, {"points", points}, {"images", used}, {"without_pose", frames - used}}};
}

}  // namespace eg::service
