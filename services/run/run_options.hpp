#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace eg::run {

/// The command line of egraph-run.
struct RunOptions {
  std::string dataset;                  ///< folder of a recording, or synthetic:SCENE
  std::filesystem::path log_in;         ///< LCM log to take the frames from instead
  std::string log_channel;              ///< where they are in it; empty: the only channel that has any
  std::optional<std::int64_t> session;  ///< which of the log's sessions; nothing: the only one
  std::string observations;             ///< feature-level data instead (folder or synthetic:walk); nothing to map then
  std::string camera;                   ///< name or YAML file; empty: found from the data set
  std::filesystem::path out;            ///< results
  std::filesystem::path load;           ///< results of an earlier run, whose map is continued; empty: a new map
  bool realtime = false;                ///< at the sensor's rate instead of in lockstep
  bool mapper = true;                   ///< also make the dense map
  std::filesystem::path config;         ///< YAML for all services; empty: their defaults
  std::int64_t depth_noise = 0;         ///< seed of noise to add to the data set's depth; 0: none
  bool log = false;                     ///< record all messages into run.lcm
  bool report = false;                  ///< describe the run in report.html
  std::int64_t frames = 0;              ///< at most; 0: all
  std::filesystem::path procman;        ///< empty: the configuration that comes with the programs
  bool view = false;                    ///< serve the run to browsers
  bool keep_view = false;               ///< until somebody stops it, also when the run is over
  std::string http;                     ///< where; empty: port 8080 of this machine only, or a free one after it
  std::string lcm_url;                  ///< empty: a port that no other run uses
};

}  // namespace eg::run
