#include "services/tracker/tracker_service.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "common/messages/channels.hpp"
#include "common/service/map_archive.hpp"
#include "services/tracker/sparse_archive.hpp"

namespace eg::services {
namespace {

/// Answers kept for frames that the source sends again; more than the source's lockstep window.
constexpr std::size_t kAnswersKept = 32;
/// Frames that may wait in lockstep. The source's window is smaller; more is somebody else's traffic.
constexpr int kMaxWaiting = 64;
/// An announced keyframe is announced again after this long (microseconds): a datagram was lost, or the server
/// restarts.
constexpr std::int64_t kAnnouncementPeriod = 300'000;
/// The newest keyframe and the newest correction are announced again and again even so: whoever missed one sees the
/// gap.
constexpr std::int64_t kDigestPeriod = 1'000'000;

/// After so long (microseconds) without a frame another session may begin.
constexpr std::int64_t kSilence = 2'000'000;
/// Sessions whose late frames are told from those of a new one.
constexpr std::size_t kFormerSessions = 64;
constexpr char kJournal[] = "tracker.journal";

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
  if (session_.waiting.size() >= std::size_t{kMaxWaiting}) return;
  session_.waiting.emplace(frame.header.sequence, WaitingFrame{frame, refusal});
  track_waiting_frames();
}

bool TrackerService::enter_session(std::int64_t id) {
  if (session_.begun && id == session_.id) return true;
  const bool goes_on = session_.begun && !session_.is_complete() && now_utime_ - session_.heard_utime < kSilence;
  if (goes_on || std::find(former_sessions_.begin(), former_sessions_.end(), id) != former_sessions_.end())
    return false;
  if (session_.begun) {
    leave_session();
    session_ = TrackedSession(id, options_);
  }
  session_.id = id;  // the first one may go on in a map that was loaded
  session_.begun = true;
  return true;
}

void TrackerService::leave_session() {
  former_sessions_.push_back(session_.id);
  if (former_sessions_.size() > kFormerSessions) former_sessions_.pop_front();
  const std::string name = "session-" + std::to_string(session_.id);
  spdlog::info("{} is over after {} frames", name, session_.next_sequence);
  const std::filesystem::path& out = context_.options().out;
  if (!out.empty()) {
    std::error_code failure;
    std::filesystem::create_directories(out / name, failure);
    const auto saved = session_.record.save(out / name, session_.tracker.map());
    if (!saved) spdlog::error("{} could not be saved: {}", name, saved.error().message);
  }
  if (!journal_) return;
  auto begun = service::MessageJournal::create(out / kJournal);
  if (begun) {
    journal_ = std::move(*begun);
  } else {
    stop_journal(begun.error().message);
  }
}

void TrackerService::on_graph_update(const egraph::GraphUpdate& update) {
  if (update.session != session_.id) return;
  const auto news = apply(update);
  if (!news) {
    context_.publish(messages::channels::kGraphRequest,
                     messages::GraphRequest{session_.id, session_.tracker.graph().version()});
    return;
  }
  note(messages::channels::kGraphUpdate, update);
  say(*news);
  track_waiting_frames();
}

void TrackerService::on_graph_snapshot(const egraph::GraphSnapshot& part) {
  if (part.session != session_.id || part.version <= session_.tracker.graph().version()) return;
  const auto snapshot = session_.snapshot.add(part);
  if (!snapshot) return;
  const auto news = apply(*snapshot);
  if (!news) return context_.status().count_rejected("EGRAPH: " + news.error().message);
  note(messages::channels::kGraphSnapshot, *snapshot);
  say(*news);
  track_waiting_frames();
}

template <typename News>
base::Result<TrackerService::Answer> TrackerService::apply(const News& of_graph) {
  auto corrected = session_.tracker.follow(of_graph);
  if (!corrected) return tl::make_unexpected(corrected.error());
  Answer news{{}, {}, session_.corrections.add(session_.id, std::move(*corrected))};
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

void TrackerService::on_restore_request(const messages::GraphRequest& request) {
  if (request.session != session_.id || request.have_version >= session_.tracker.graph().version()) return;
  for (const egraph::GraphSnapshot& part : egraph::split(session_.tracker.graph().snapshot(session_.id))) {
    context_.publish(messages::channels::kRestore, part);
  }
}

void TrackerService::on_resend_request(const messages::ResendRequest& request) {
  if (request.session != session_.id || request.numbers.empty()) return;
  if (request.channel == messages::channels::kPose) {
    for (const std::int64_t keyframe : request.numbers) {
      const auto answer = session_.keyframe_answers.find(keyframe);
      if (answer != session_.keyframe_answers.end()) context_.publish(messages::channels::kPose, answer->second);
    }
  } else if (request.channel == messages::channels::kKeyframeFeatures) {
    for (const std::int64_t keyframe : request.numbers) {
      const auto keyframes = session_.tracker.map().keyframes();
      const bool known = keyframe >= 0 && keyframe < static_cast<std::int64_t>(keyframes.size());
      if (known)
        context_.publish(messages::channels::kKeyframeFeatures, keyframes[static_cast<std::size_t>(keyframe)].features);
    }
  } else if (request.channel == messages::channels::kPoseCorrection) {
    announce(session_.corrections.since(request.numbers.front()));
  }
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

void TrackerService::stop_journal(const std::string& why) {
  spdlog::warn("a tracker that is killed from now on cannot resume: {}", why);
  journal_.reset();
  std::error_code ignored;  // what cannot be written can mostly be removed; if not, the sentence above holds as well
  std::filesystem::remove(context_.options().out / kJournal, ignored);
}

tracking::PoseEstimate TrackerService::remember(tracking::PoseEstimate estimate) {
  estimate.corrections = session_.corrections.version();
  if (estimate.keyframe.valid()) session_.keyframe_answers.emplace(estimate.keyframe.value, estimate);
  session_.answered.emplace(estimate.header.sequence, estimate);
  if (session_.answered.size() > kAnswersKept) session_.answered.erase(session_.answered.begin());
  return estimate;
}

base::Status TrackerService::resume(std::uint64_t most_bytes) {
  most_journal_bytes_ = most_bytes;
  const std::filesystem::path path = context_.options().out / kJournal;
  auto journal =
      service::MessageJournal::resume(path, [this](const transport::LogEvent& event) { return replay(event); });
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
    enter_session(frame->header.session);
    conclude(session_.tracker.track(*frame));
    return {};
  }
  if (event.channel == messages::channels::kPose) {
    const auto refused = messages::decode<tracking::PoseEstimate>(event.bytes);
    if (!refused) return tl::make_unexpected(refused.error());
    enter_session(refused->header.session);
    conclude({*refused, {}, {}});
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
  if (!written) return stop_journal(written.error().message);
  if (journal_->size() > most_journal_bytes_) {
    stop_journal("the journal of " + std::to_string(journal_->size() / 1'000'000) + " MB is larger than it may be");
  }
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
                   messages::Acknowledge{session_.id, sequence, context_.options().name});
}

void TrackerService::announce(const std::vector<tracking::PoseCorrection>& corrections) {
  for (const tracking::PoseCorrection& correction : corrections) {
    context_.publish(messages::channels::kPoseCorrection, correction);
  }
}

void TrackerService::repeat_newest() {
  announce(session_.corrections.since(session_.corrections.version() - 1));
  if (session_.newest_keyframe && !context_.options().lockstep) {
    context_.publish(messages::channels::kKeyframe, *session_.newest_keyframe);
  }
}

void TrackerService::idle(std::int64_t now_utime) {
  now_utime_ = now_utime;
  if (now_utime - last_digest_utime_ >= kDigestPeriod) {
    last_digest_utime_ = now_utime;
    repeat_newest();
  }
  if (session_.unconfirmed.empty()) {
    last_announcement_utime_ = now_utime;
    return;
  }
  if (now_utime - last_announcement_utime_ < kAnnouncementPeriod) return;
  last_announcement_utime_ = now_utime;
  context_.publish(messages::channels::kKeyframe, session_.unconfirmed.front());
}

base::Status TrackerService::load(const std::filesystem::path& archive) {
  auto loaded = load_sparse_archive(service::file_in_archive(archive, service::kSparseMapFile));
  if (!loaded) return tl::make_unexpected(loaded.error());
  session_.record.set_earlier_keyframes(loaded->map.keyframes().size());
  session_.tracker.continue_in(std::move(loaded->map), std::move(loaded->graph));
  return {};
}

base::Status TrackerService::save() {
  const std::filesystem::path& out = context_.options().out;
  if (out.empty()) return {};
  if (const base::Status saved = session_.record.save(out, session_.tracker.map());
      !saved || session_.tracker.map().empty())
    return saved;
  const std::filesystem::path archive = service::archive_folder(out);
  std::error_code failure;
  std::filesystem::create_directories(archive, failure);
  if (failure) return base::fail(archive.string() + ": cannot be made: " + failure.message());
  return save_sparse_archive(archive / service::kSparseMapFile, session_.tracker.map(), session_.tracker.graph());
}

}  // namespace eg::services
