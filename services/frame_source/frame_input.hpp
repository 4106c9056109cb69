#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/geometry/pose.hpp"
#include "services/frame_source/source_frame.hpp"

namespace eg::services {

/// What the frame source reads from.
struct InputOptions {
  std::string dataset = "synthetic:room";    ///< folder of a recording, synthetic:SCENE or log:FILE
  std::string observations = {};             ///< folder of a recording of features, instead of the data set
  std::string camera = {};                   ///< name or YAML file; empty: found from the data set
  std::int64_t max_frames = 0;               ///< 0: all
  std::int64_t seed = 1;                     ///< of synthetic textures and noise
  std::int64_t depth_noise = 0;              ///< seed of noise that is added to recorded depth images; 0: none
  bool noise = true;                         ///< what is synthetic has the noise of a structured-light camera
  std::optional<std::int64_t> session = {};  ///< of a log: which of those in it; nothing: the only one
  std::string log_channel = {};              ///< of a log: where its frames are; empty: the only one that has any
};

/// A recording, read frame by frame. read() is called from one thread, not always the one that made the input.
class FrameInput {
 public:
  virtual ~FrameInput() = default;

  [[nodiscard]] virtual std::int64_t size() const = 0;
  /// Acquisition time of frame `index`, microseconds; known without reading it.
  [[nodiscard]] virtual std::int64_t utime(std::int64_t index) const = 0;
  /// Frame `index` in [0, size()); of its header only the time counts. The error names the file.
  [[nodiscard]] virtual base::Result<SourceFrame> read(std::int64_t index) const = 0;
  /// Number of the recording or robot, unless the user chooses another.
  [[nodiscard]] virtual std::int64_t session() const { return 1; }
  /// Acquisition times (microseconds) of frames that are known to be unreadable and are not among the size() frames.
  [[nodiscard]] virtual std::vector<std::int64_t> skipped_utimes() const { return {}; }
  /// The true poses, where the input makes them itself; recordings keep theirs in a file of their own.
  [[nodiscard]] virtual std::vector<geometry::StampedPose> ground_truth() const { return {}; }
  /// One line for the log: what is read, with which camera.
  [[nodiscard]] virtual std::string description() const = 0;
};

/// Opens a recording of images or features, a log or a synthetic scene. A recording's first frame is read once: a
/// camera or a format that does not fit is an error here, not 1000 skipped frames later.
base::Result<std::unique_ptr<FrameInput>> open_input(const InputOptions& options);

}  // namespace eg::services
