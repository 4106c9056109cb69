#include "services/mapper/mapper_service.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <system_error>

#include "common/messages/channels.hpp"
#include "services/mapper/map_files.hpp"

namespace eg::services {
namespace {

constexpr std::int64_t kMaxAhead = 16;        // frames in lockstep; the source sends fewer ahead
constexpr int kLockstepFrameQueue = 16;       // more than the source sends ahead, with repetitions
constexpr int kRealtimeFrameQueue = 8;        // while a keyframe is being fused
constexpr std::int64_t kSilence = 2'000'000;  // microseconds without a frame or pose: another session may begin
constexpr std::size_t kFormerSessions = 64;   // whose late messages are told from those of a new one

}  // namespace

MapperService::MapperService(service::ServiceContext& context, const MapperOptions& options)
    : context_(context), options_(options), session_(std::make_unique<MappedSession>(options)) {
  context_.rename(with_share(context_.options().name, options_.tsdf));
  const int frame_queue = context_.options().lockstep ? kLockstepFrameQueue : kRealtimeFrameQueue;
  context_.subscribe<messages::CompressedFrame>(messages::channels::kRgbd, frame_queue,
                                                [this](const messages::CompressedFrame& frame) { on_frame(frame); });
  if (options_.plane_regularisation) {
    const auto take_features = [this](const features::FrameFeatures& features) { on_features(features); };
    context_.subscribe<features::FrameFeatures>(messages::channels::kFeatures, frame_queue, take_features);
    if (!context_.options().lockstep) {
      context_.subscribe<features::FrameFeatures>(messages::channels::kKeyframeFeatures, frame_queue, take_features);
    }
  }
  context_.subscribe<tracking::PoseEstimate>(messages::channels::kPose, service::kSmallQueue,
                                             [this](const tracking::PoseEstimate& pose) { on_pose(pose); });
  if (!context_.options().lockstep) {
    context_.subscribe<egraph::Keyframe>(messages::channels::kKeyframe, service::kStateQueue,
                                         [this](const egraph::Keyframe& keyframe) { on_keyframe(keyframe); });
  }
  context_.subscribe<tracking::PoseCorrection>(
      messages::channels::kPoseCorrection, service::kStateQueue,
      [this](const tracking::PoseCorrection& correction) { on_correction(correction); });
  context_.subscribe<messages::MeshRequest>(messages::channels::kMeshRequest, 30,
                                            [this](const messages::MeshRequest& request) {
                                              if (request.session == session_->id) session_->mesh_stream.repeat_all();
                                            });
  context_.subscribe<messages::EndOfStream>(messages::channels::kEndOfStream, 2,
                                            [this](const messages::EndOfStream& end) { on_end_of_stream(end); });
}

base::Status MapperService::open(const std::filesystem::path& archive) {
  if (auto limited = limit_memory(context_.options().out, options_, session_->map); !limited) return limited;
  if (!archive.empty()) {
    if (auto loaded = load_map(archive, session_->map); !loaded) return loaded;
    const auto& keyframes = session_->map.keyframes();
    if (!keyframes.empty()) session_->queue.begin_behind(keyframes.rbegin()->first);
  }
  return begin_journal(options_.resume);
}

template <typename T>
void MapperService::note(const char* channel, const T& value) {
  if (!journal_) return;
  if (const base::Status written = journal_->add(channel, value); !written) stop_journal(written.error());
}

void MapperService::stop_journal(const base::Error& error) {
  spdlog::warn("a mapper that is killed from now on cannot resume: {}", error.message);
  journal_.reset();
}

bool MapperService::enter_session(std::int64_t id, const char* channel) {
  if (session_->id != id) {
    const bool is_silent = now_utime_ - session_->heard_utime >= kSilence;
    const bool goes_on = session_->id && !session_->is_complete() && !is_silent;
    if (goes_on || std::find(former_sessions_.begin(), former_sessions_.end(), id) != former_sessions_.end()) {
      context_.status().count_rejected(std::string(channel) +
                                       ": field 'session' differs from the session being mapped");
      return false;
    }
    if (session_->id) leave_session();
    session_->id = id;  // the first one may go on in a map that was loaded
  }
  session_->heard_utime = now_utime_;
  return true;
}

void MapperService::leave_session() {
  former_sessions_.push_back(*session_->id);
  if (former_sessions_.size() > kFormerSessions) former_sessions_.pop_front();
  const std::string name = "session-" + std::to_string(*session_->id);
  spdlog::info("{} is over with {} keyframes in the map", name, session_->map.keyframe_count());
  const std::filesystem::path& out = context_.options().out;
  if (!out.empty()) {
    std::error_code failure;
    std::filesystem::create_directories(out / name, failure);
    const auto saved = save_map(out / name, session_->map);
    if (!saved) spdlog::error("{} could not be saved: {}", name, saved.error().message);
  }
  session_.reset();  // and with it the folder that its map had
  session_ = std::make_unique<MappedSession>(options_);
  if (const auto limited = limit_memory(out, options_, session_->map); !limited) {
    spdlog::warn("the map is kept in memory as a whole: {}", limited.error().message);
  }
  if (!journal_) return;
  if (const auto begun = begin_journal(false); !begun) stop_journal(begun.error());
}

void MapperService::on_end_of_stream(const messages::EndOfStream& end) {
  if (end.session == session_->id) session_->frame_count = end.frame_count;
}

void MapperService::on_frame(const messages::CompressedFrame& frame) {
  if (!enter_session(frame.header.session, messages::channels::kRgbd)) return;
  const std::int64_t sequence = frame.header.sequence;
  if (context_.options().lockstep) {
    if (sequence < session_->next_sequence) return acknowledge_finished();
    if (sequence >= session_->next_sequence + kMaxAhead) return;  // the source sends it again
  }
  session_->parts_of(sequence).images = frame;
  context_.options().lockstep ? work_off_in_order() : finish_if_complete(sequence);
}

void MapperService::on_features(const features::FrameFeatures& features) {
  if (!enter_session(features.header.session, messages::channels::kFeatures)) return;
  const std::int64_t sequence = features.header.sequence;
  if (context_.options().lockstep &&
      (sequence < session_->next_sequence || sequence >= session_->next_sequence + kMaxAhead))
    return;
  session_->parts_of(sequence).features = planes_only(features);
  context_.options().lockstep ? work_off_in_order() : finish_if_complete(sequence);
}

void MapperService::on_pose(const tracking::PoseEstimate& pose) {
  if (!enter_session(pose.header.session, messages::channels::kPose)) return;
  session_->corrections.announce(pose.corrections);
  const std::int64_t sequence = pose.header.sequence;
  if (!context_.options().lockstep) return take_pose(pose);
  if (sequence < session_->next_sequence || sequence >= session_->next_sequence + kMaxAhead) return;
  session_->poses.emplace(sequence, pose);
  work_off_in_order();
}

void MapperService::on_keyframe(const egraph::Keyframe& keyframe) {
  if (enter_session(keyframe.header.session, messages::channels::kKeyframe)) session_->queue.announce(keyframe.id);
}

void MapperService::on_correction(const tracking::PoseCorrection& correction) {
  if (!enter_session(correction.session, messages::channels::kPoseCorrection) ||
      !session_->corrections.take(correction))
    return;
  session_->map.correct(correction);
  note(messages::channels::kPoseCorrection, correction);
  work_off_in_order();
}

void MapperService::work_off_in_order() {
  for (;; ++session_->next_sequence) {
    const auto frame = session_->frames.find(session_->next_sequence);
    const auto pose = session_->poses.find(session_->next_sequence);
    if (frame == session_->frames.end() || pose == session_->poses.end() || !is_complete(frame->second, pose->second) ||
        !session_->corrections.has(pose->second.corrections))
      break;
    integrate(frame->second, pose->second);
    session_->frames.erase(frame);
    session_->poses.erase(pose);
  }
  if (session_->next_sequence > session_->acknowledged) acknowledge_finished();
}

bool MapperService::is_complete(const FrameParts& parts, const tracking::PoseEstimate& pose) const {
  return parts.images && (parts.features || !options_.plane_regularisation || !is_mapped(pose));
}

void MapperService::integrate(const FrameParts& parts, const tracking::PoseEstimate& pose) {
  if (!is_mapped(pose) || session_->map.contains(pose.keyframe)) return;
  const auto start = std::chrono::steady_clock::now();
  const features::FrameFeatures features = parts.features.value_or(features::FrameFeatures{});
  const auto done = session_->map.integrate(pose.keyframe, *parts.images, pose.world_from_camera, features);
  if (!done) {
    return context_.status().count_rejected(std::string(messages::channels::kRgbd) + ": " + done.error().message);
  }
  note(messages::channels::kRgbd, *parts.images);
  if (parts.features) note(messages::channels::kFeatures, *parts.features);
  note(messages::channels::kPose, pose);
  keep_budget();
  context_.status().count_frame(
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
}

void MapperService::request(const char* channel, const std::vector<std::int64_t>& numbers) {
  if (!numbers.empty())
    context_.publish(messages::channels::kResend, messages::ResendRequest{*session_->id, channel, numbers});
}

void MapperService::acknowledge_finished() {
  session_->acknowledged = session_->next_sequence;
  const messages::Acknowledge done{*session_->id, session_->next_sequence - 1, context_.options().name};
  note(messages::channels::kAcknowledge, done);
  context_.publish(messages::channels::kAcknowledge, done);
}

void MapperService::keep_budget() {
  const base::Status kept = session_->map.field().keep_budget();
  const std::string failure = kept ? "" : kept.error().message;
  if (!kept && failure != budget_failure_) {
    spdlog::error("the map takes more memory than it should, for it cannot be put away: {}", failure);
  }
  budget_failure_ = failure;
}

void MapperService::idle(std::int64_t now_utime) {
  now_utime_ = now_utime;
  if (const auto moved = session_->map.move_next(); !moved) {
    context_.status().count_rejected(std::string(messages::channels::kPoseCorrection) + ": " + moved.error().message);
  }
  if (session_->id) {
    request_missing(now_utime);
    send_mesh(now_utime);
  }
  keep_budget();
}

void MapperService::send_mesh(std::int64_t now_utime) {
  const auto chunks = session_->mesh_stream.next(session_->map.field(), *session_->id, now_utime);
  if (!chunks) return spdlog::error("a part of the mesh cannot be sent: {}", chunks.error().message);
  for (const mapping::MeshChunk& chunk : *chunks) context_.publish(messages::channels::kMeshChunk, chunk);
}

base::Status MapperService::save() {
  const std::filesystem::path& out = context_.options().out;
  return out.empty() ? base::Status() : save_map(out, session_->map);
}

}  // namespace eg::services
