#include "services/run/input.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "common/io/camera_file.hpp"
#include "common/io/dataset.hpp"
#include "common/io/observation_source.hpp"
#include "common/recording/frame_log.hpp"
#include "common/synthetic/sequence.hpp"

namespace eg::run {
namespace {

constexpr std::string_view kSynthetic = "synthetic:";

std::int64_t limited(std::int64_t available, std::int64_t limit) {
  return limit > 0 ? std::min(available, limit) : available;
}

/// The services' working folder may be another one.
std::string absolute_if_file(const std::string& name_or_file) {
  std::error_code ignored;
  const bool is_file = std::filesystem::exists(name_or_file, ignored) && !geometry::find_camera(name_or_file);
  return is_file ? std::filesystem::absolute(name_or_file).string() : name_or_file;
}

base::Result<Input> inspect_synthetic(const RunOptions& options) {
  synthetic::SequenceOptions sequence_options = synthetic::sequence_named(options.dataset.substr(kSynthetic.size()));
  if (!options.camera.empty()) {
    const auto camera = io::read_camera(options.camera);
    if (!camera) return tl::make_unexpected(camera.error());
    sequence_options.camera = *camera;
  }
  const auto sequence = synthetic::SyntheticSequence::make(sequence_options);
  if (!sequence) return tl::make_unexpected(sequence.error());
  Input input;
  input.dataset = options.dataset;
  input.y_up = sequence_options.camera.fy < 0.0;
  input.frames = limited(sequence->size(), options.frames);
  input.description = "synthetic scene '" + sequence_options.scene + "', camera " + sequence_options.camera.name;
  input.ground_truth = options.out / "groundtruth.txt";  // written by the frame source
  return input;
}

base::Result<Input> inspect_recording(const RunOptions& options) {
  const auto dataset = io::open_dataset(options.dataset);
  if (!dataset) return tl::make_unexpected(dataset.error());
  const auto camera_option = options.camera.empty() ? std::nullopt : std::optional<std::string>(options.camera);
  const auto camera = io::resolve_camera(options.dataset, camera_option);
  if (!camera) return tl::make_unexpected(camera.error());
  if (const auto frame = io::read_frame(*dataset, 0, camera->camera); !frame) return tl::make_unexpected(frame.error());
  Input input;
  input.dataset = std::filesystem::absolute(options.dataset).string();
  input.y_up = camera->camera.fy < 0.0;
  input.frames = limited(static_cast<std::int64_t>(dataset->frames.size()), options.frames);
  input.description = options.dataset + ", " + camera->how;
  input.ground_truth = dataset->ground_truth;
  return input;
}

base::Result<Input> inspect_observations(const RunOptions& options) {
  const auto camera_option = options.camera.empty() ? std::nullopt : std::optional<std::string>(options.camera);
  const auto source = io::open_observations(options.observations, camera_option, {});
  if (!source) return tl::make_unexpected(source.error());
  Input input;
  input.observations = absolute_if_file(options.observations);
  input.y_up = source->camera.camera.fy < 0.0;
  input.frames = limited(static_cast<std::int64_t>(source->recording.frames.size()), options.frames);
  input.description = "observations of " + options.observations + ", " + source->camera.how;
  input.ground_truth = options.out / "groundtruth.txt";  // written by the frame source
  return input;
}

base::Result<Input> inspect_log(const RunOptions& options) {
  const std::filesystem::path folder = std::filesystem::absolute(options.log_in).parent_path();
  std::error_code absent;
  if (std::filesystem::equivalent(folder, options.out, absent)) {
    return base::fail("the log " + options.log_in.string() + " is in the folder " + options.out.string() +
                      ", whose contents would be replaced: choose another for --out");
  }
  const auto log = recording::FrameLog::open(options.log_in, {options.log_channel, options.session});
  if (!log) return tl::make_unexpected(log.error());
  Input input;
  input.dataset = "log:" + std::filesystem::absolute(options.log_in).string();
  input.y_up = log->camera().fy < 0.0;
  input.frames = limited(static_cast<std::int64_t>(log->frames().size()), options.frames);
  input.session = log->session();
  input.description =
      options.log_in.string() + ", session " + std::to_string(log->session()) + ", camera " + log->camera().name;
  input.ground_truth = folder / "groundtruth.txt";  // if the run that was recorded left one
  return input;
}

base::Result<Input> inspect(const RunOptions& options) {
  if (!options.log_in.empty()) return inspect_log(options);
  if (!options.observations.empty()) return inspect_observations(options);
  return options.dataset.starts_with(kSynthetic) ? inspect_synthetic(options) : inspect_recording(options);
}

}  // namespace

base::Result<Input> inspect_input(const RunOptions& options) {
  auto input = inspect(options);
  if (input) input->camera = absolute_if_file(options.camera);
  return input;
}

}  // namespace eg::run
