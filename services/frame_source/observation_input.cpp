#include "services/frame_source/observation_input.hpp"

#include <cmath>
#include <utility>

#include "common/io/observation_source.hpp"
#include "common/observations/frame_features.hpp"

namespace eg::services {
namespace {

/// Features with known identities, from a recording that holds no images.
class ObservationInput : public FrameInput {
 public:
  ObservationInput(std::string name, io::ObservationSource source, const observations::SensorModel& sensor)
      : name_(std::move(name)),
        recording_(std::move(source.recording)),
        camera_(std::move(source.camera)),
        sensor_(sensor) {}

  [[nodiscard]] std::int64_t size() const override { return static_cast<std::int64_t>(recording_.frames.size()); }

  [[nodiscard]] std::int64_t utime(std::int64_t index) const override {
    return std::llround(recording_.frames[static_cast<std::size_t>(index)].time_s * 1e6);
  }

  [[nodiscard]] base::Result<SourceFrame> read(std::int64_t index) const override {
    return observations::features_of(recording_, static_cast<std::size_t>(index), camera_.camera, sensor_);
  }

  [[nodiscard]] std::vector<geometry::StampedPose> ground_truth() const override {
    std::vector<geometry::StampedPose> poses;
    for (const observations::RecordedFrame& frame : recording_.frames) {
      poses.push_back({frame.time_s, frame.world_from_camera});
    }
    return poses;
  }

  [[nodiscard]] std::string description() const override {
    return name_ + ": " + std::to_string(size()) + " frames of observations, " + camera_.how;
  }

 private:
  std::string name_;
  observations::Recording recording_;
  io::ResolvedCamera camera_;
  observations::SensorModel sensor_;
};

}  // namespace

base::Result<std::unique_ptr<FrameInput>> open_observations(const InputOptions& options) {
  const auto name = options.camera.empty() ? std::nullopt : std::optional(options.camera);
  observations::SensorModel sensor;
  sensor.depth_noise = options.noise;
  sensor.seed = static_cast<std::uint64_t>(options.seed);
  auto source = io::open_observations(options.observations, name, sensor);
  if (!source) return tl::make_unexpected(source.error());
  auto& frames = source->recording.frames;
  if (options.max_frames > 0 && static_cast<std::size_t>(options.max_frames) < frames.size()) {
    frames.resize(static_cast<std::size_t>(options.max_frames));
  }
  return std::make_unique<ObservationInput>(options.observations, *std::move(source), sensor);
}

}  // namespace eg::services
