#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace eg::messages {

/// A consumer is done with a frame and all frames before it (lockstep).
struct Acknowledge {
  std::int64_t session = 0;
  std::int64_t sequence = 0;
  std::string consumer;  ///< service name, e.g. "tracker"
};

/// The frame source has sent its last frame.
struct EndOfStream {
  std::int64_t session = 0;
  std::int64_t frame_count = 0;              ///< frames that were sent
  std::vector<std::int64_t> skipped_utimes;  ///< acquisition times (microseconds) of frames that could not be read
};

enum class Command : std::uint8_t {
  save = 0,      ///< write results into the service's own --out folder
  shutdown = 1,  ///< end the process
};

/// A request to all services (or one). It carries no path: what a message can make a service write is fixed by the
/// service's own command line.
struct Control {
  std::int64_t request_id = 0;  ///< repeated in the reply; a repeated request is answered again, not done again
  Command command = Command::save;
  std::string service;  ///< name of the service meant; empty: all
};

struct ControlReply {
  std::int64_t request_id = 0;
  std::string service;
  bool ok = false;
  std::string message;  ///< one sentence if not ok
};

/// Asks the E-Graph server for a snapshot.
struct GraphRequest {
  std::int64_t session = 0;
  std::int64_t have_version = 0;  ///< what the asker has; 0: nothing
};

/// Asks the mappers to send their whole mesh again.
struct MeshRequest {
  std::int64_t session = 0;
};

/// Asks for messages that were lost on the way.
struct ResendRequest {
  std::int64_t session = 0;
  std::string channel;  ///< of the messages
  /// On RGBD frames by their sequence, on POSE and KEYFRAME_FEATURES keyframes by their id, on POSE_CORRECTION the one
  /// version up to which the asker has everything.
  std::vector<std::int64_t> numbers;
};

/// How a service is doing. Latency: from receiving a message to having published its result, milliseconds.
struct ServiceStatus {
  std::int64_t utime = 0;
  std::string service;
  std::string host;
  std::int32_t pid = 0;
  std::string state;           ///< e.g. "running", "saving"
  std::int64_t frames = 0;     ///< messages processed
  std::int64_t dropped = 0;    ///< frames missed, by gaps in the sequence numbers
  std::int64_t rejected = 0;   ///< messages that failed validation
  std::string last_rejection;  ///< why the last of them did
  double latency_p50_ms = 0.0;
  double latency_p90_ms = 0.0;
  double latency_p99_ms = 0.0;
  double latency_max_ms = 0.0;
  double cpu_seconds = 0.0;            ///< user and system time since start
  std::int64_t peak_memory_bytes = 0;  ///< peak resident set
};

}  // namespace eg::messages
