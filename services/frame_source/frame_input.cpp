#include "services/frame_source/frame_input.hpp"

#include <algorithm>
#include <string_view>

#include "common/io/camera_file.hpp"
#include "common/io/dataset.hpp"
#include "common/synthetic/sequence.hpp"
#include "services/frame_source/log_input.hpp"
#include "services/frame_source/observation_input.hpp"

namespace eg::services {
namespace {

constexpr std::string_view kSynthetic = "synthetic:";
constexpr std::string_view kLog = "log:";

std::int64_t limited(std::int64_t available, std::int64_t max_frames) {
  return max_frames > 0 ? std::min(available, max_frames) : available;
}

class RecordedInput : public FrameInput {
 public:
  RecordedInput(io::Dataset dataset, io::ResolvedCamera camera, std::int64_t max_frames, std::int64_t depth_noise)
      : dataset_(std::move(dataset)),
        camera_(std::move(camera)),
        size_(limited(static_cast<std::int64_t>(dataset_.frames.size()), max_frames)),
        depth_noise_(static_cast<std::uint64_t>(depth_noise)) {}

  [[nodiscard]] std::int64_t size() const override { return size_; }

  [[nodiscard]] std::int64_t utime(std::int64_t index) const override {
    return dataset_.frames[static_cast<std::size_t>(index)].utime;
  }

  [[nodiscard]] base::Result<SourceFrame> read(std::int64_t index) const override {
    return io::read_frame(dataset_, static_cast<std::size_t>(index), camera_.camera).map([this](const auto& frame) {
      const synthetic::DepthNoiseOptions noise;
      return SourceFrame(
          messages::compress(depth_noise_ == 0 ? frame : synthetic::add_depth_noise(frame, noise, depth_noise_)));
    });
  }

  [[nodiscard]] std::string description() const override {
    return dataset_.folder.string() + ": " + std::to_string(size_) + " frames (" +
           std::string(io::to_string(dataset_.layout)) + "; " + std::to_string(dataset_.unpaired_colour) +
           " colour and " + std::to_string(dataset_.unpaired_depth) + " depth images without a partner), " +
           camera_.how + (depth_noise_ == 0 ? "" : ", with synthetic depth noise");
  }

 private:
  io::Dataset dataset_;
  io::ResolvedCamera camera_;
  std::int64_t size_;
  std::uint64_t depth_noise_;  ///< seed; 0: none
};

class SyntheticInput : public FrameInput {
 public:
  SyntheticInput(synthetic::SyntheticSequence sequence, std::int64_t max_frames)
      : sequence_(std::move(sequence)), size_(limited(sequence_.size(), max_frames)) {}

  [[nodiscard]] std::int64_t size() const override { return size_; }
  [[nodiscard]] std::int64_t utime(std::int64_t index) const override {
    return sequence_.utime(static_cast<int>(index));
  }
  [[nodiscard]] base::Result<SourceFrame> read(std::int64_t index) const override {
    return messages::compress(sequence_.frame(static_cast<int>(index)));
  }
  [[nodiscard]] std::vector<geometry::StampedPose> ground_truth() const override {
    std::vector<geometry::StampedPose> poses = sequence_.ground_truth();
    poses.resize(static_cast<std::size_t>(size_));
    return poses;
  }
  [[nodiscard]] std::string description() const override {
    const synthetic::SequenceOptions& options = sequence_.options();
    return "synthetic scene '" + options.scene + "', seed " + std::to_string(options.seed) + ": " +
           std::to_string(size_) + " frames, camera " + options.camera.name;
  }

 private:
  synthetic::SyntheticSequence sequence_;
  std::int64_t size_;
};

base::Result<std::unique_ptr<FrameInput>> open_synthetic(const InputOptions& options) {
  synthetic::SequenceOptions sequence_options = synthetic::sequence_named(options.dataset.substr(kSynthetic.size()));
  sequence_options.seed = static_cast<std::uint64_t>(options.seed);
  if (!options.camera.empty()) {
    const auto camera = io::read_camera(options.camera);
    if (!camera) return tl::make_unexpected(camera.error());
    sequence_options.camera = *camera;
  }
  if (options.noise) sequence_options.noise = synthetic::NoiseOptions{};
  auto sequence = synthetic::SyntheticSequence::make(sequence_options);
  if (!sequence) return tl::make_unexpected(sequence.error());
  return std::make_unique<SyntheticInput>(*std::move(sequence), options.max_frames);
}

base::Result<std::unique_ptr<FrameInput>> open_recording(const InputOptions& options) {
  auto dataset = io::open_dataset(options.dataset);
  if (!dataset) return tl::make_unexpected(dataset.error());
  const auto name = options.camera.empty() ? std::nullopt : std::optional(options.camera);
  auto camera = io::resolve_camera(options.dataset, name);
  if (!camera) return tl::make_unexpected(camera.error());
  auto input =
      std::make_unique<RecordedInput>(*std::move(dataset), *std::move(camera), options.max_frames, options.depth_noise);
  if (const auto first = input->read(0); !first) return tl::make_unexpected(first.error());
  return input;
}

}  // namespace

base::Result<std::unique_ptr<FrameInput>> open_input(const InputOptions& options) {
  if (options.max_frames < 0) return base::fail("the number of frames must not be negative");
  if (options.depth_noise < 0) return base::fail("the seed of the depth noise must not be negative");
  if (!options.observations.empty()) return open_observations(options);
  if (options.dataset.starts_with(kLog)) return open_log(options.dataset.substr(kLog.size()), options);
  return options.dataset.starts_with(kSynthetic) ? open_synthetic(options) : open_recording(options);
}

}  // namespace eg::services
