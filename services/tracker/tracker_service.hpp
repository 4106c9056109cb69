#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/service/message_journal.hpp"
#include "common/service/service.hpp"
#include "services/tracker/tracked_session.hpp"

namespace eg::services {

/// More than an hour at 30 frames a second.
inline constexpr std::uint64_t kMostJournalBytes = 16'000'000'000;

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
/// A frame whose message is refused is answered, too: its POSE has no pose and says why.
///
/// With a journal, a tracker that was killed comes back as it was: tracking is deterministic, so that the frames, the
/// answers to those that were refused and the updates of the graph are all that its state follows from. Each is on the
/// disk before anybody hears of its result.
///
/// One session at a time. Frames of another one begin a new map when the one before has ended, or nothing was heard of
/// it for some seconds; its results are then saved to session-<id>/ within the output folder.
class TrackerService : public service::Service {
 public:
  TrackerService(service::ServiceContext& context, tracking::TrackerOptions options);

  /// Once, before the first message: goes on in the map archive of an earlier session. Refuses a damaged one.
  base::Status load(const std::filesystem::path& archive);

  /// Once, before the first message: goes on from tracker.journal in the output folder and keeps it from now on, until
  /// it is larger than `most_bytes`: then it is removed with a warning, and the tracker goes on without. Fails if it
  /// cannot be written or is damaged.
  base::Status resume(std::uint64_t most_bytes = kMostJournalBytes);

  void idle(std::int64_t now_utime) override;

  /// Writes trajectory.txt, states.csv, keyframes.txt, map.ply, map.pcd and the sparse part of the map archive, all of
  /// the session being tracked.
  base::Status save() override;

 private:
  /// `refusal`: why it is refused, then it has a header only; empty: it is not.
  void on_features(const features::FrameFeatures& frame, const std::string& refusal);
  void on_refused_features(messages::ByteView bytes, const std::string& why);
  /// Whether a frame's number is one that no source would give: it must not shut out all that come after it. In real
  /// time a second frame behind it makes it believed.
  bool is_absurd(std::int64_t sequence);
  /// Makes it the session being tracked, unless another one goes on. Whether it is.
  bool enter_session(std::int64_t id);
  void leave_session();
  void on_graph_update(const egraph::GraphUpdate& update);
  void on_graph_snapshot(const egraph::GraphSnapshot& part);
  void on_restore_request(const messages::GraphRequest& request);
  void on_resend_request(const messages::ResendRequest& request);
  void on_end_of_stream(const messages::EndOfStream& end);

  void track_waiting_frames();
  void track(const WaitingFrame& frame);
  /// What is to be said after a frame or an update of the graph.
  struct Answer {
    std::optional<tracking::PoseEstimate> estimate;
    std::optional<egraph::Keyframe> keyframe;
    std::vector<tracking::PoseCorrection> corrections;
  };
  /// Takes a frame's result into the session.
  Answer conclude(tracking::TrackResult result);
  /// The graph is newer, and the map has followed it: `moved` keyframes are announced, and the answer that waited for
  /// it is released.
  Answer follow_graph(std::vector<tracking::PoseCorrection::Entry> moved);
  tracking::PoseEstimate remember(tracking::PoseEstimate estimate);
  base::Status replay(const transport::LogEvent& event);
  template <typename T>
  void note(const char* channel, const T& value) {
    if (journal_) check_journal(journal_->add(channel, value));
  }
  void check_journal(const base::Status& written);
  /// Goes on without, and leaves none that would end before the state that others have heard of.
  void stop_journal(const std::string& why);
  void say(const Answer& news);
  void answer(const tracking::PoseEstimate& estimate);
  void acknowledge(std::int64_t sequence);
  void announce(const std::vector<tracking::PoseCorrection>& corrections);
  void repeat_newest();
  [[nodiscard]] bool waits_for_graph() const;

  static constexpr char kJournal[] = "tracker.journal";

  service::ServiceContext& context_;
  tracking::TrackerOptions options_;
  TrackedSession session_;
  std::deque<std::int64_t> former_sessions_;
  std::optional<service::MessageJournal> journal_;
  std::uint64_t most_journal_bytes_ = kMostJournalBytes;
  std::int64_t now_utime_ = 0;  ///< as idle() was told last
  std::int64_t last_digest_utime_ = 0;
  std::int64_t last_announcement_utime_ = 0;
};

}  // namespace eg::services
