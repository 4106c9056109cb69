#include "services/tracker/tracker_service.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "common/messages/channels.hpp"

namespace eg::services {
namespace {

/// Answers kept for frames that the source sends again; more than the source's lockstep window.
constexpr std::size_t kAnswersKept = 32;
/// Frames that may wait in lockstep. The source's window is smaller; more is somebody else's traffic.
constexpr int kMaxWaiting = 64;
/// Frames that may be missing at once in real time: more than a minute of any camera.
constexpr std::int64_t kMaxLeap = 10'000;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

TrackerService::TrackerService(service::ServiceContext& context, tracking::TrackerOptions options)
    : context_(context), options_(options), session_(0, options) {
  const int capacity = context_.options().lockstep ? kMaxWaiting : 2;
  context_.subscribe<features::FrameFeatures>(
      messages::channels::kFeatures, capacity, [this](const features::FrameFeatures& frame) { on_features(frame, {}); },
      [this](messages::ByteView bytes, const std::string& why) { on_refused_features(bytes, why); });
  context_.subscribe<egraph::GraphUpdate>(messages::channels::kGraphUpdate, service::kStateQueue,
                                          [this](const egraph::GraphUpdate& update) { on_graph_update(update); });
  context_.subscribe<egraph::GraphSnapshot>(
      messages::channels::kGraphSnapshot, service::kStateQueue,
      [this](const egraph::GraphSnapshot& snapshot) { on_graph_snapshot(snapshot); });
  context_.subscribe<messages::GraphRequest>(
      messages::channels::kRestoreRequest, 2,
      [this](const messages::GraphRequest& request) { on_restore_request(request); });
  context_.subscribe<messages::ResendRequest>(
      messages::channels::kResend, 8, [this](const messages::ResendRequest& request) { on_resend_request(request); });
  context_.subscribe<messages::EndOfStream>(messages::channels::kEndOfStream, 2,
                                            [this](const messages::EndOfStream& end) { on_end_of_stream(end); });
}

void TrackerService::on_refused_features(messages::ByteView bytes, const std::string& why) {
  // Else lockstep would wait for this frame for ever, and no result say what became of it.
  const auto header = messages::decode_features_header(bytes);
  if (!header) return;
  features::FrameFeatures nothing;
  nothing.header = *header;
  on_features(nothing, "refused: " + why);
}

void TrackerService::on_features(const features::FrameFeatures& frame, const std::string& refusal) {
  if (!enter_session(frame.header.session)) {
    context_.status().count_rejected("FEATURES: field 'session' differs from the session being tracked");
    return;
  }
  session_.heard_utime = now_utime_;
  if (const auto known = session_.answered.find(frame.header.sequence); known != session_.answered.end()) {
    answer(known->second);
    return;
  }
  const std::int64_t first_unanswered =
      session_.held_answer ? session_.held_answer->header.sequence : session_.next_sequence;
  if (frame.header.sequence < first_unanswered) return acknowledge(first_unanswered - 1);  // of a source started anew
  if (frame.header.sequence < session_.next_sequence) return;
  if (is_absurd(frame.header.sequence)) {
    context_.status().count_rejected("FEATURES: field 'sequence' leaps from " +
                                     std::to_string(session_.next_sequence - 1) + " to " +
                                     std::to_string(frame.header.sequence));
    return;
  }
  session_.waiting.emplace(frame.header.sequence, WaitingFrame{frame, refusal});
  track_waiting_frames();
}

bool TrackerService::is_absurd(std::int64_t sequence) {
  if (context_.options().lockstep) return sequence >= session_.next_sequence + kMaxWaiting;
  if (session_.record.empty() || sequence - session_.next_sequence <= kMaxLeap) {
    session_.leap.reset();
    return false;
  }
  const std::optional<std::int64_t> before = std::exchange(session_.leap, sequence);
  return !before || sequence <= *before || sequence - *before > kMaxLeap;
}

void TrackerService::on_graph_update(const egraph::GraphUpdate& update) {
  if (update.session != session_.id) return;
  auto corrected = session_.tracker.follow(update);
  if (!corrected) {
    context_.publish(messages::channels::kGraphRequest,
                     messages::GraphRequest{session_.id, session_.tracker.graph().version()});
    return;
  }
  const Answer news = follow_graph(*std::move(corrected));
  note(messages::channels::kGraphUpdate, update);
  say(news);
  track_waiting_frames();
}

void TrackerService::on_graph_snapshot(const egraph::GraphSnapshot& part) {
  if (part.session != session_.id || part.version <= session_.tracker.graph().version()) return;
  const auto snapshot = session_.snapshot.add(part);
  if (!snapshot) return;
  auto corrected = session_.tracker.follow(*snapshot);
  if (!corrected) return context_.status().count_rejected("EGRAPH: " + corrected.error().message);
  const Answer news = follow_graph(*std::move(corrected));
  note(messages::channels::kGraphSnapshot, *snapshot);
  say(news);
  track_waiting_frames();
}

TrackerService::Answer TrackerService::follow_graph(std::vector<tracking::PoseCorrection::Entry> moved) {
  Answer news{{}, {}, session_.corrections.add(session_.id, std::move(moved))};
  while (!session_.unconfirmed.empty() &&
         session_.tracker.graph().find_keyframe(session_.unconfirmed.front().id) != nullptr) {
    session_.unconfirmed.pop_front();
  }
  if (session_.held_answer && !waits_for_graph()) {
    news.estimate = remember(*session_.held_answer);
    session_.held_answer.reset();
  }
  return news;
}

void TrackerService::on_end_of_stream(const messages::EndOfStream& end) {
  if (end.session == session_.id) session_.record.set_end(end.frame_count, end.skipped_utimes);
}

bool TrackerService::waits_for_graph() const { return context_.options().lockstep && !session_.unconfirmed.empty(); }

void TrackerService::track_waiting_frames() {
  while (!session_.waiting.empty() && !waits_for_graph()) {
    const auto first = session_.waiting.begin();
    if (context_.options().lockstep && first->first != session_.next_sequence)
      return;  // lost on the way; the source sends it again
    const WaitingFrame frame = std::move(first->second);
    session_.waiting.erase(first);
    track(frame);
  }
}

void TrackerService::track(const WaitingFrame& frame) {
  const auto start = std::chrono::steady_clock::now();
  if (frame.refusal.empty()) {
    const Answer result = conclude(session_.tracker.track(frame.features));
    note(messages::channels::kFeatures, frame.features);
    say(result);
  } else {
    const tracking::TrackResult refused = session_.tracker.refuse(frame.features.header, frame.refusal);
    note(messages::channels::kPose, refused.estimate);
    say(conclude(refused));
  }
  context_.status().count_frame(milliseconds_since(start));
}

TrackerService::Answer TrackerService::conclude(tracking::TrackResult result) {
  const image::FrameHeader header = result.estimate.header;
  context_.status().count_sequence(header.session, header.sequence);
  session_.next_sequence = header.sequence + 1;
  session_.record.add(result.estimate, session_.tracker.map());
  Answer answer{{}, std::move(result.keyframe), session_.corrections.add(session_.id, std::move(result.corrections))};
  if (answer.keyframe) {
    session_.newest_keyframe = *answer.keyframe;
    session_.unconfirmed.push_back(*answer.keyframe);
  }
  if (waits_for_graph()) {
    session_.held_answer = std::move(result.estimate);
  } else {
    answer.estimate = remember(std::move(result.estimate));
  }
  return answer;
}

tracking::PoseEstimate TrackerService::remember(tracking::PoseEstimate estimate) {
  estimate.corrections = session_.corrections.version();
  if (estimate.keyframe.valid()) session_.keyframe_answers.emplace(estimate.keyframe.value, estimate);
  session_.answered.emplace(estimate.header.sequence, estimate);
  if (session_.answered.size() > kAnswersKept) session_.answered.erase(session_.answered.begin());
  return estimate;
}

}  // namespace eg::services
