#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/geometry/camera_model.hpp"
#include "common/image/rgbd_frame.hpp"
#include "common/synthetic/noise.hpp"
#include "common/synthetic/renderer.hpp"
#include "common/synthetic/trajectory.hpp"

namespace eg::synthetic {

struct SequenceOptions {
  std::string scene = "room";
  std::string trajectory;  ///< empty: the one named like the scene
  geometry::CameraModel camera = *geometry::find_camera("synthetic");
  int frame_count = 0;                               ///< 0: as long as the trajectory is worth watching
  std::uint64_t seed = 1;                            ///< of textures and noise
  std::optional<NoiseOptions> noise = std::nullopt;  ///< none: frames are exact but for the depth's unit
  std::int64_t session = 0;
  std::int64_t start_utime = 1'000'000;  ///< acquisition time of frame 0, microseconds
};

/// The sequence that people call SCENE, or SCENE:TRAJECTORY for another motion than the scene's own (`room:spin`).
SequenceOptions sequence_named(std::string_view name);

/// Says what is wrong with the options (unknown names, invalid camera, negative count).
base::Status validate(const SequenceOptions& options);

/// A recording that is made when it is read: frames of a scene along a trajectory, with exact poses.
/// Frame i depends on the options and i only. Cheap to copy; const functions may be called from several threads.
class SyntheticSequence {
 public:
  static base::Result<SyntheticSequence> make(const SequenceOptions& options);

  [[nodiscard]] int size() const { return options_.frame_count; }
  [[nodiscard]] const SequenceOptions& options() const { return options_; }
  [[nodiscard]] const Scene& scene() const { return renderer_->scene(); }

  /// Acquisition time of frame `index`, microseconds.
  [[nodiscard]] std::int64_t utime(int index) const;
  [[nodiscard]] geometry::Pose world_from_camera(int index) const;
  [[nodiscard]] geometry::StampedPose ground_truth(int index) const;
  [[nodiscard]] std::vector<geometry::StampedPose> ground_truth() const;

  /// The frame without noise, with exact depth and what every pixel sees.
  [[nodiscard]] Rendering render(int index) const;

  /// The frame as the camera gives it.
  [[nodiscard]] image::RgbdFrame frame(int index) const;

 private:
  SyntheticSequence(SequenceOptions options, Trajectory trajectory, std::shared_ptr<const Renderer> renderer)
      : options_(std::move(options)), trajectory_(std::move(trajectory)), renderer_(std::move(renderer)) {}

  SequenceOptions options_;
  Trajectory trajectory_;
  std::shared_ptr<const Renderer> renderer_;
};

}  // namespace eg::synthetic
