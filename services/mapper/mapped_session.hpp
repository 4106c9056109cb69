#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "common/service/correction_follower.hpp"
#include "services/mapper/keyframe_map.hpp"
#include "services/mapper/keyframe_queue.hpp"
#include "services/mapper/mapper_options.hpp"
#include "services/mapper/mesh_stream.hpp"

namespace eg::services {

/// What has come of a frame.
struct FrameParts {
  std::optional<messages::CompressedFrame> images;
  std::optional<features::FrameFeatures> features;  ///< its planes
  std::int64_t arrival = 0;                         ///< how many frames had come when the first part did
};

/// All that the mapper knows of one session.
struct MappedSession {
  explicit MappedSession(const MapperOptions& options);

  std::optional<std::int64_t> id;  ///< none: nothing has come yet
  KeyframeMap map;
  MeshStream mesh_stream;
  KeyframeQueue queue;                                   ///< real time
  service::CorrectionFollower corrections;               ///< which of them have come
  std::int64_t next_sequence = 0;                        ///< lockstep: the first frame that is not finished
  std::int64_t acknowledged = 0;                         ///< lockstep: next_sequence when it was last announced
  std::map<std::int64_t, FrameParts> frames;             ///< by sequence
  std::int64_t arrivals = 0;                             ///< frames of which anything has come
  std::map<std::int64_t, tracking::PoseEstimate> poses;  ///< lockstep: by sequence
  std::optional<std::int64_t> frame_count;               ///< of the source, once it has ended
  std::int64_t heard_utime = 0;                          ///< when the last frame or pose came

  /// What has come of frame `sequence`, of which something has come now.
  FrameParts& parts_of(std::int64_t sequence);

  /// Lockstep: whether every frame that the source had is in the map.
  [[nodiscard]] bool is_complete() const { return frame_count && next_sequence >= *frame_count; }
};

}  // namespace eg::services
