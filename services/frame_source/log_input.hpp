#pragma once

#include <filesystem>
#include <memory>

#include "services/frame_source/frame_input.hpp"

namespace eg::services {

/// The frames that an LCM log holds, as they were recorded. A damaged log gives what can be read of it, with a warning
/// that says how much is missing.
base::Result<std::unique_ptr<FrameInput>> open_log(const std::filesystem::path& file, const InputOptions& options);

}  // namespace eg::services
