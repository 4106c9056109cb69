#pragma once

#include <optional>
#include <string>

#include "common/base/result.hpp"
#include "common/io/camera_file.hpp"
#include "common/observations/frame_features.hpp"
#include "common/observations/recording.hpp"

namespace eg::io {

/// A recording of features and the camera that made it.
struct ObservationSource {
  observations::Recording recording;
  ResolvedCamera camera;
};

/// Opens feature-level data: a folder in the text format of Open-Structure (read_open_structure), or `synthetic:walk`
/// (observations::make_walk), which is measured with `sensor`. The camera: `camera` (a name or file), else as
/// resolve_camera() finds it, or `synthetic` for the walk.
base::Result<ObservationSource> open_observations(const std::string& source, const std::optional<std::string>& camera,
                                                  const observations::SensorModel& sensor);

}  // namespace eg::io
