#pragma once

#include <memory>

#include "services/frame_source/frame_input.hpp"

namespace eg::services {

/// Opens a recording of features, options.observations: a folder in the text format of Open-Structure, or
/// synthetic:walk.
base::Result<std::unique_ptr<FrameInput>> open_observations(const InputOptions& options);

}  // namespace eg::services
