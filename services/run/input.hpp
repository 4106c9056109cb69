#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/base/result.hpp"
#include "services/run/run_options.hpp"

namespace eg::run {

/// What is known of the input before anything is started.
struct Input {
  std::string dataset;                 ///< absolute path, synthetic:SCENE or log:FILE; empty: observations
  std::string observations;            ///< absolute path; empty: a data set
  std::string camera;                  ///< name, or absolute path of a file; empty: found from the data set
  std::string description;             ///< for people
  bool y_up = false;                   ///< the camera's fy is negative
  std::int64_t frames = 0;             ///< to be expected
  std::int64_t session = 1;            ///< number of the recording, in every message
  std::filesystem::path ground_truth;  ///< empty: none. May come into being during the run.
};

/// Checks the input as far as that is quick: folder, lists, camera, the first images, all observations. The error says
/// what is wrong with which file.
base::Result<Input> inspect_input(const RunOptions& options);

}  // namespace eg::run
