#pragma once

#include <filesystem>

namespace eg::test {

/// Writes the first `frames` frames of the synthetic room as a folder in TUM RGB-D layout: rgb.txt, depth.txt, rgb/ and
/// depth/ with 0.png, 1.png, ..., groundtruth.txt and camera.yaml.
void write_recording(const std::filesystem::path& folder, int frames);

}  // namespace eg::test
