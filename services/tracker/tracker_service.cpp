#include "services/tracker/tracker_service.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "common/messages/channels.hpp"

namespace eg::services {
namespace {

/// Answers kept for frames that the source sends again; more than the source's lockstep window.
constexpr std::size_t kAnswersKept = 32;
/// Frames that may wait in lockstep. The source's window is smaller; more is somebody else's traffic.
constexpr std::size_t kMaxWaiting = 64;
/// An announced keyframe is announced again after this long (microseconds): a datagram was lost, or the server
/// restarts.
constexpr std::int64_t kAnnouncementPeriod = 300'000;
/// The newest keyframe and the newest correction are announced again and again even so: whoever missed one sees the
/// gap.
constexpr std::int64_t kDigestPeriod = 1'000'000;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

TrackerService::TrackerService(service::ServiceContext& context, tracking::TrackerOptions options)
    : context_(context), tracker_(options) {
  const int capacity = context_.options().lockstep ? 0 : 2;
  context_.subscribe<features::FrameFeatures>(messages::channels::kFeatures, capacity,
                                              [this](const features::FrameFeatures& frame) { on_features(frame); });
  context_.subscribe<egraph::GraphUpdate>(messages::channels::kGraphUpdate, 0,
                                          [this](const egraph::GraphUpdate& update) { on_graph_update(update); });
  context_.subscribe<egraph::GraphSnapshot>(
      messages::channels::kGraphSnapshot, 0,
      [this](const egraph::GraphSnapshot& snapshot) { on_graph_snapshot(snapshot); });
  context_.subscribe<messages::GraphRequest>(
      messages::channels::kRestoreRequest, 2,
      [this](const messages::GraphRequest& request) { on_restore_request(request); });
  context_.subscribe<messages::ResendRequest>(
      messages::channels::kResend, 8, [this](const messages::ResendRequest& request) { on_resend_request(request); });
  context_.subscribe<messages::EndOfStream>(messages::channels::kEndOfStream, 2,
                                            [this](const messages::EndOfStream& end) { on_end_of_stream(end); });
}

void TrackerService::on_features(const features::FrameFeatures& frame) {
  if (record_.empty() && waiting_.empty()) session_ = frame.header.session;
  if (frame.header.session != session_) {
    context_.status().count_rejected("FEATURES: field 'session' differs from the session being tracked");
    return;
  }
  if (const auto known = answered_.find(frame.header.sequence); known != answered_.end()) {
    answer(known->second);
    return;
  }
  const std::int64_t first_unanswered = held_answer_ ? held_answer_->header.sequence : next_sequence_;
  if (frame.header.sequence < first_unanswered) return acknowledge(first_unanswered - 1);  // of a source started anew
  if (frame.header.sequence < next_sequence_) return;
  if (waiting_.size() >= kMaxWaiting) return;
  waiting_.emplace(frame.header.sequence, frame);
  track_waiting_frames();
}

void TrackerService::on_graph_update(const egraph::GraphUpdate& update) {
  if (update.session != session_) return;
  const auto news = apply(update);
  if (!news) {
    context_.publish(messages::channels::kGraphRequest, messages::GraphRequest{session_, tracker_.graph().version()});
    return;
  }
  note(messages::channels::kGraphUpdate, update);
  say(*news);
  track_waiting_frames();
}

void TrackerService::on_graph_snapshot(const egraph::GraphSnapshot& part) {
  if (part.session != session_ || part.version <= tracker_.graph().version()) return;
  const auto snapshot = snapshot_.add(part);
  if (!snapshot) return;
  const auto news = apply(*snapshot);
  if (!news) return context_.status().count_rejected("EGRAPH: " + news.error().message);
  note(messages::channels::kGraphSnapshot, *snapshot);
  say(*news);
  track_waiting_frames();
}

template <typename News>
base::Result<TrackerService::Answer> TrackerService::apply(const News& of_graph) {
  auto corrected = tracker_.follow(of_graph);
  if (!corrected) return tl::make_unexpected(corrected.error());
  Answer news{{}, {}, corrections_.add(session_, std::move(*corrected))};
  while (!unconfirmed_.empty() && tracker_.graph().find_keyframe(unconfirmed_.front().id) != nullptr) {
    unconfirmed_.pop_front();
  }
  if (held_answer_ && !waits_for_graph()) {
    news.estimate = remember(*held_answer_);
    held_answer_.reset();
  }
  return news;
}

void TrackerService::on_restore_request(const messages::GraphRequest& request) {
  if (request.session != session_ || request.have_version >= tracker_.graph().version()) return;
  for (const egraph::GraphSnapshot& part : egraph::split(tracker_.graph().snapshot(session_))) {
    context_.publish(messages::channels::kRestore, part);
  }
}

void TrackerService::on_resend_request(const messages::ResendRequest& request) {
  if (request.session != session_ || request.numbers.empty()) return;
  if (request.channel == messages::channels::kPose) {
    for (const std::int64_t keyframe : request.numbers) {
      const auto answer = keyframe_answers_.find(keyframe);
      if (answer != keyframe_answers_.end()) context_.publish(messages::channels::kPose, answer->second);
    }
  } else if (request.channel == messages::channels::kFeatures) {
    for (const std::int64_t keyframe : request.numbers) {
      const auto keyframes = tracker_.map().keyframes();
      const bool known = keyframe >= 0 && keyframe < static_cast<std::int64_t>(keyframes.size());
      if (known)
        context_.publish(messages::channels::kFeatures, keyframes[static_cast<std::size_t>(keyframe)].features);
    }
  } else if (request.channel == messages::channels::kPoseCorrection) {
    announce(corrections_.since(request.numbers.front()));
  }
}

void TrackerService::on_end_of_stream(const messages::EndOfStream& end) {
  if (end.session == session_) record_.set_end(end.frame_count, end.skipped_utimes);
}

bool TrackerService::waits_for_graph() const { return context_.options().lockstep && !unconfirmed_.empty(); }

void TrackerService::track_waiting_frames() {
  while (!waiting_.empty() && !waits_for_graph()) {
    const auto first = waiting_.begin();
    if (context_.options().lockstep && first->first != next_sequence_)
      return;  // lost on the way; the source sends it again
    const features::FrameFeatures frame = std::move(first->second);
    waiting_.erase(first);
    track(frame);
  }
}

void TrackerService::track(const features::FrameFeatures& frame) {
  const auto start = std::chrono::steady_clock::now();
  const Answer result = compute(frame);
  note(messages::channels::kFeatures, frame);
  say(result);
  context_.status().count_frame(milliseconds_since(start));
}

TrackerService::Answer TrackerService::compute(const features::FrameFeatures& frame) {
  context_.status().count_sequence(frame.header.session, frame.header.sequence);
  tracking::TrackResult result = tracker_.track(frame);
  next_sequence_ = frame.header.sequence + 1;
  record_.add(result.estimate, tracker_.map());
  Answer answer{{}, std::move(result.keyframe), corrections_.add(session_, std::move(result.corrections))};
  if (answer.keyframe) {
    newest_keyframe_ = *answer.keyframe;
    unconfirmed_.push_back(*answer.keyframe);
  }
  if (waits_for_graph()) {
    held_answer_ = std::move(result.estimate);
  } else {
    answer.estimate = remember(std::move(result.estimate));
  }
  return answer;
}

tracking::PoseEstimate TrackerService::remember(tracking::PoseEstimate estimate) {
  estimate.corrections = corrections_.version();
  if (estimate.keyframe.valid()) keyframe_answers_.emplace(estimate.keyframe.value, estimate);
  answered_.emplace(estimate.header.sequence, estimate);
  if (answered_.size() > kAnswersKept) answered_.erase(answered_.begin());
  return estimate;
}

base::Status TrackerService::resume() {
  const std::filesystem::path path = context_.options().out / "tracker.journal";
  auto journal = service::Journal::resume(path, [this](const transport::LogEvent& event) { return replay(event); });
  if (!journal) return tl::make_unexpected(journal.error());
  journal_ = std::move(*journal);
  return {};
}

template <typename News>
base::Status TrackerService::replay_news(messages::ByteView bytes) {
  const auto news = messages::decode<News>(bytes);
  if (!news) return tl::make_unexpected(news.error());
  if (const auto applied = apply(*news); !applied) return tl::make_unexpected(applied.error());
  return {};
}

base::Status TrackerService::replay(const transport::LogEvent& event) {
  if (event.channel == messages::channels::kFeatures) {
    const auto frame = messages::decode<features::FrameFeatures>(event.bytes);
    if (!frame) return tl::make_unexpected(frame.error());
    session_ = frame->header.session;
    compute(*frame);
    return {};
  }
  if (event.channel == messages::channels::kGraphUpdate) return replay_news<egraph::GraphUpdate>(event.bytes);
  if (event.channel == messages::channels::kGraphSnapshot) return replay_news<egraph::GraphSnapshot>(event.bytes);
  return base::fail("a journal has no channel " + event.channel);
}

template <typename T>
void TrackerService::note(const char* channel, const T& value) {
  if (!journal_) return;
  const base::Status written = journal_->add(channel, value);
  if (written) return;
  spdlog::warn("a tracker that is killed from now on cannot resume: {}", written.error().message);
  journal_.reset();
}

void TrackerService::say(const Answer& news) {
  if (news.keyframe) context_.publish(messages::channels::kKeyframe, *news.keyframe);
  announce(news.corrections);
  if (news.estimate) answer(*news.estimate);
}

void TrackerService::answer(const tracking::PoseEstimate& estimate) {
  context_.publish(messages::channels::kPose, estimate);
  acknowledge(estimate.header.sequence);
}

void TrackerService::acknowledge(std::int64_t sequence) {
  context_.publish(messages::channels::kAcknowledge,
                   messages::Acknowledge{session_, sequence, context_.options().name});
}

void TrackerService::announce(const std::vector<tracking::PoseCorrection>& corrections) {
  for (const tracking::PoseCorrection& correction : corrections) {
    context_.publish(messages::channels::kPoseCorrection, correction);
  }
}

void TrackerService::repeat_newest() {
  announce(corrections_.since(corrections_.version() - 1));
  if (newest_keyframe_ && !context_.options().lockstep) {
    context_.publish(messages::channels::kKeyframe, *newest_keyframe_);
  }
}

void TrackerService::idle(std::int64_t now_utime) {
  if (now_utime - last_digest_utime_ >= kDigestPeriod) {
    last_digest_utime_ = now_utime;
    repeat_newest();
  }
  if (unconfirmed_.empty()) {
    last_announcement_utime_ = now_utime;
    return;
  }
  if (now_utime - last_announcement_utime_ < kAnnouncementPeriod) return;
  last_announcement_utime_ = now_utime;
  context_.publish(messages::channels::kKeyframe, unconfirmed_.front());
}

base::Status TrackerService::save() {
  if (context_.options().out.empty()) return {};
  return record_.save(context_.options().out, tracker_.map());
}

}  // namespace eg::services
