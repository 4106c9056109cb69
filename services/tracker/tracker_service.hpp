#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "common/egraph/snapshot_parts.hpp"
#include "common/service/journal.hpp"
#include "common/service/service.hpp"
#include "common/tracking/tracker.hpp"
#include "services/tracker/correction_record.hpp"
#include "services/tracker/track_record.hpp"

namespace eg::services {

/// FEATURES in; POSE, KEYFRAME and POSE_CORRECTION out. Keeps its replica of the E-Graph by EGRAPH_UPDATE.
///
/// Lockstep: frames are tracked strictly in order, and a keyframe is answered, and the next frame tracked, when the
/// server's update has come and the map has followed it, so that the result does not depend on timing. A frame seen
/// before is answered again, not tracked again. Real time: what waits is dropped for the newest frame; updates are
/// applied when they come. Either way a keyframe is announced again until the server's update for it arrives. A server
/// that has lost its graph gets the replica. Keyframes' POSE and FEATURES messages and corrections are sent again to
/// those who ask (RESEND); to let them see what they miss, every POSE carries the version of the newest correction, and
/// the newest correction is repeated once a second, in real time the newest KEYFRAME, too.
///
/// With a journal, a tracker that was killed comes back as it was: tracking is deterministic, so that the frames and
/// the updates of the graph are all that its state follows from. Each is on the disk before anybody hears of its
/// result.
class TrackerService : public service::Service {
 public:
  TrackerService(service::ServiceContext& context, tracking::TrackerOptions options);

  /// Once, before the first message: goes on from tracker.journal in the output folder and keeps it from now on. Fails
  /// if it cannot be written or is damaged.
  base::Status resume();

  void idle(std::int64_t now_utime) override;

  /// Writes trajectory.txt, states.csv, keyframes.txt and map.ply.
  base::Status save() override;

 private:
  void on_features(const features::FrameFeatures& frame);
  void on_graph_update(const egraph::GraphUpdate& update);
  void on_graph_snapshot(const egraph::GraphSnapshot& part);
  void on_restore_request(const messages::GraphRequest& request);
  void on_resend_request(const messages::ResendRequest& request);
  void on_end_of_stream(const messages::EndOfStream& end);

  void track_waiting_frames();
  void track(const features::FrameFeatures& frame);
  /// What is to be said after a frame or an update of the graph.
  struct Answer {
    std::optional<tracking::PoseEstimate> estimate;
    std::optional<egraph::Keyframe> keyframe;
    std::vector<tracking::PoseCorrection> corrections;
  };
  Answer compute(const features::FrameFeatures& frame);
  /// An update of the graph or a whole one: moves the map after it, and releases the answer that waited for it.
  template <typename News>
  base::Result<Answer> apply(const News& of_graph);
  tracking::PoseEstimate remember(tracking::PoseEstimate estimate);
  template <typename News>
  base::Status replay_news(messages::ByteView bytes);
  base::Status replay(const transport::LogEvent& event);
  template <typename T>
  void note(const char* channel, const T& value);
  void say(const Answer& news);
  void answer(const tracking::PoseEstimate& estimate);
  void acknowledge(std::int64_t sequence);
  void announce(const std::vector<tracking::PoseCorrection>& corrections);
  void repeat_newest();
  [[nodiscard]] bool waits_for_graph() const;

  service::ServiceContext& context_;
  tracking::Tracker tracker_;
  egraph::SnapshotAssembler snapshot_;
  TrackRecord record_;
  std::optional<service::Journal> journal_;
  std::int64_t session_ = 0;
  std::int64_t next_sequence_ = 0;
  std::map<std::int64_t, features::FrameFeatures> waiting_;          ///< by sequence
  std::map<std::int64_t, tracking::PoseEstimate> answered_;          ///< recent ones, for frames that come again
  std::deque<egraph::Keyframe> unconfirmed_;                         ///< announced, no update yet
  std::optional<tracking::PoseEstimate> held_answer_;                ///< to a keyframe: the graph's update comes first
  std::map<std::int64_t, tracking::PoseEstimate> keyframe_answers_;  ///< all, by keyframe
  std::optional<egraph::Keyframe> newest_keyframe_;                  ///< announced once a second in real time
  CorrectionRecord corrections_;
  std::int64_t last_digest_utime_ = 0;
  std::int64_t last_announcement_utime_ = 0;
};

}  // namespace eg::services
