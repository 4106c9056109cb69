#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "common/egraph/snapshot_parts.hpp"
#include "common/tracking/tracker.hpp"
#include "services/tracker/correction_record.hpp"
#include "services/tracker/track_record.hpp"

namespace eg::services {

/// A frame in the order of sequence numbers.
struct WaitingFrame {
  features::FrameFeatures features;  ///< of one that was refused the header alone
  std::string refusal;               ///< why it was refused; empty: it was not
};

/// All that the tracker knows of one session.
struct TrackedSession {
  TrackedSession(std::int64_t number, const tracking::TrackerOptions& options) : id(number), tracker(options) {}

  std::int64_t id;
  tracking::Tracker tracker;
  egraph::SnapshotAssembler snapshot;
  TrackRecord record;
  std::int64_t next_sequence = 0;
  std::optional<std::int64_t> leap;  ///< real time: a number too far ahead to be believed by itself
  std::map<std::int64_t, WaitingFrame> waiting;                     ///< by sequence
  std::map<std::int64_t, tracking::PoseEstimate> answered;          ///< recent ones, for frames that come again
  std::deque<egraph::Keyframe> unconfirmed;                         ///< announced, no update yet
  std::optional<tracking::PoseEstimate> held_answer;                ///< to a keyframe: the graph's update comes first
  std::map<std::int64_t, tracking::PoseEstimate> keyframe_answers;  ///< all, by keyframe
  std::optional<egraph::Keyframe> newest_keyframe;                  ///< announced once a second in real time
  CorrectionRecord corrections;
  bool begun = false;            ///< a frame has come
  std::int64_t heard_utime = 0;  ///< when the last one came

  /// Whether every frame that the source had was tracked and every keyframe is in the graph.
  [[nodiscard]] bool is_complete() const {
    return record.frame_count() > 0 && next_sequence >= record.frame_count() && unconfirmed.empty();
  }
};

}  // namespace eg::services
