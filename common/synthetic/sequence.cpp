#include "common/synthetic/sequence.hpp"

#include <cmath>

#include "common/base/check.hpp"
#include "common/synthetic/depth_encoding.hpp"

namespace eg::synthetic {
namespace {

std::string trajectory_name(const SequenceOptions& options) {
  return options.trajectory.empty() ? options.scene : options.trajectory;
}

}  // namespace

SequenceOptions sequence_named(std::string_view name) {
  SequenceOptions options;
  const std::size_t colon = name.find(':');
  options.scene = name.substr(0, colon);
  if (colon != std::string_view::npos) options.trajectory = name.substr(colon + 1);
  return options;
}

base::Status validate(const SequenceOptions& options) {
  if (const auto camera = geometry::validate(options.camera); !camera) return camera;
  if (options.frame_count < 0) return base::fail("the number of frames of a synthetic sequence must not be negative");
  if (options.noise) return validate(*options.noise);
  return {};
}

base::Result<SyntheticSequence> SyntheticSequence::make(const SequenceOptions& options) {
  if (const auto valid = validate(options); !valid) return tl::make_unexpected(valid.error());
  auto scene = make_scene(options.scene, options.seed);
  if (!scene) return tl::make_unexpected(scene.error());
  auto trajectory = make_trajectory(trajectory_name(options));
  if (!trajectory) return tl::make_unexpected(trajectory.error());

  SequenceOptions complete = options;
  if (complete.frame_count == 0) {
    complete.frame_count = static_cast<int>(std::floor(trajectory->duration_s * options.camera.fps));
  }
  return SyntheticSequence(std::move(complete), *std::move(trajectory),
                           std::make_shared<const Renderer>(*std::move(scene), options.camera));
}

std::int64_t SyntheticSequence::utime(int index) const {
  return options_.start_utime + std::llround(1e6 * index / options_.camera.fps);
}

geometry::Pose SyntheticSequence::world_from_camera(int index) const {
  return trajectory_.world_from_camera(1e-6 * static_cast<double>(utime(index) - options_.start_utime));
}

geometry::StampedPose SyntheticSequence::ground_truth(int index) const {
  return {1e-6 * static_cast<double>(utime(index)), world_from_camera(index)};
}

std::vector<geometry::StampedPose> SyntheticSequence::ground_truth() const {
  std::vector<geometry::StampedPose> poses;
  for (int i = 0; i < size(); ++i) poses.push_back(ground_truth(i));
  return poses;
}

Rendering SyntheticSequence::render(int index) const {
  EG_CHECK(index >= 0 && index < size(), "a frame of the sequence");
  return renderer_->render(world_from_camera(index));
}

image::RgbdFrame SyntheticSequence::frame(int index) const {
  const Rendering exact = render(index);
  const geometry::CameraModel& camera = options_.camera;
  const image::RgbdFrame frame{{options_.session, index, utime(index)},
                               camera,
                               exact.colour,
                               encode_depth(exact.depth, camera.depth_units_per_metre)};
  return options_.noise ? add_noise(frame, *options_.noise, options_.seed) : frame;
}

}  // namespace eg::synthetic
