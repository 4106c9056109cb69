#include "services/mapper/mapper_service.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <ostream>
#include <system_error>

#include "common/io/atomic_file.hpp"
#include "common/io/pcd.hpp"
#include "common/messages/channels.hpp"
#include "common/service/map_archive.hpp"
#include "services/mapper/dense_archive.hpp"

namespace eg::services {
namespace {

constexpr std::int64_t kMaxAhead = 16;        // frames in lockstep; the source sends fewer ahead
constexpr std::size_t kMaxRecentFrames = 32;  // one second, in real time: what a pose may take
constexpr int kLockstepFrameQueue = 16;       // more than the source sends ahead, with repetitions
constexpr int kRealtimeFrameQueue = 8;        // while a keyframe is being fused
constexpr double kMicroseconds = 1e6;
constexpr std::size_t kMegabyte = 1'000'000;

bool is_mapped(const tracking::PoseEstimate& pose) {
  return pose.keyframe.valid() && pose.has_pose && pose.state == tracking::TrackingState::tracking;
}

/// As polygons and as a cloud.
base::Status write_mesh(const std::filesystem::path& stem, const mapping::Mesh& mesh) {
  const base::Status ply = io::write_ply(stem.string() + ".ply", io::view_of(mesh));
  return ply ? io::write_pcd(stem.string() + ".pcd", io::view_of(mesh)) : ply;
}

}  // namespace

MapperService::MapperService(service::ServiceContext& context, const MapperOptions& options)
    : context_(context),
      map_(options.tsdf, static_cast<std::size_t>(options.image_budget) * kMegabyte),
      mesh_stream_(static_cast<std::int64_t>(options.mesh_period * kMicroseconds)),
      resume_(options.resume) {
  context_.subscribe<messages::CompressedFrame>(messages::channels::kRgbd,
                                                context_.options().lockstep ? kLockstepFrameQueue : kRealtimeFrameQueue,
                                                [this](const messages::CompressedFrame& frame) { on_frame(frame); });
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
                                              if (session_ && request.session == *session_) mesh_stream_.repeat_all();
                                            });
}

std::string MapperService::with_share(const std::string& name) const {
  const mapping::TsdfOptions& options = map_.field().options();
  return options.shares == 1 ? name : name + "." + std::to_string(options.share);
}

base::Status MapperService::load(const std::filesystem::path& archive) {
  const std::string name = with_share(service::kDenseMapName) + ".map";
  const base::Status loaded = load_dense_archive(service::file_in_archive(archive, name), map_);
  if (loaded && !map_.keyframes().empty()) queue_.begin_behind(map_.keyframes().rbegin()->first);
  return loaded;
}

base::Status MapperService::open_journal() {
  if (context_.options().out.empty()) return {};
  const std::filesystem::path path = context_.options().out / (with_share("mapper") + ".journal");
  auto journal = resume_ ? service::MessageJournal::resume(
                               path, [this](const transport::LogEvent& event) { return replay(event); })
                         : service::MessageJournal::create(path);
  if (!journal) return tl::make_unexpected(journal.error());
  journal_ = std::move(*journal);
  return {};
}

base::Status MapperService::replay(const transport::LogEvent& event) {
  const auto apply = [&]<typename T>(auto handle) -> base::Status {
    const auto value = messages::decode<T>(event.bytes);
    if (!value) return tl::make_unexpected(value.error());
    handle(*value);
    return {};
  };
  if (event.channel == messages::channels::kRgbd) {
    return apply.operator()<messages::CompressedFrame>([this](const auto& frame) { replayed_ = frame; });
  }
  if (event.channel == messages::channels::kPose) {
    return apply.operator()<tracking::PoseEstimate>([this](const auto& pose) {
      session_ = pose.header.session;
      if (replayed_) integrate(*replayed_, pose);
    });
  }
  if (event.channel == messages::channels::kPoseCorrection) {
    return apply.operator()<tracking::PoseCorrection>([this](const auto& correction) {
      corrections_.take(correction);
      map_.correct(correction);
    });
  }
  if (event.channel == messages::channels::kAcknowledge) {
    return apply.operator()<messages::Acknowledge>([this](const auto& acknowledge) {
      session_ = acknowledge.session;
      next_sequence_ = acknowledge.sequence + 1;
    });
  }
  return base::fail("a journal has no channel " + event.channel);
}

template <typename T>
void MapperService::note(const char* channel, const T& value) {
  if (!journal_) return;
  const base::Status written = journal_->add(channel, value);
  if (written) return;
  spdlog::warn("a mapper that is killed from now on cannot resume: {}", written.error().message);
  journal_.reset();
}

bool MapperService::is_my_session(std::int64_t session, const char* channel) {
  if (!session_) session_ = session;
  if (session == *session_) return true;
  context_.status().count_rejected(std::string(channel) + ": field 'session' differs from the session being mapped");
  return false;
}

void MapperService::on_frame(const messages::CompressedFrame& frame) {
  if (!is_my_session(frame.header.session, messages::channels::kRgbd)) return;
  const std::int64_t sequence = frame.header.sequence;
  if (!context_.options().lockstep) {
    if (const tracking::PoseEstimate* pose = queue_.waiting_for(sequence)) return finish_keyframe(frame, *pose);
    frames_.insert_or_assign(sequence, frame);
    if (frames_.size() > kMaxRecentFrames) frames_.erase(frames_.begin());
    return;
  }
  if (sequence < next_sequence_) return acknowledge_finished();
  if (sequence >= next_sequence_ + kMaxAhead) return;  // the source sends it again
  frames_.emplace(sequence, frame);
  work_off_in_order();
}

void MapperService::on_pose(const tracking::PoseEstimate& pose) {
  if (!is_my_session(pose.header.session, messages::channels::kPose)) return;
  corrections_.announce(pose.corrections);
  const std::int64_t sequence = pose.header.sequence;
  if (!context_.options().lockstep) {
    if (!pose.keyframe.valid() || !queue_.add_pose(pose)) return;
    if (!is_mapped(pose) || map_.contains(pose.keyframe)) return queue_.finish(pose.keyframe);
    const auto frame = frames_.find(sequence);
    if (frame != frames_.end()) finish_keyframe(frame->second, pose);
    return;
  }
  if (sequence < next_sequence_ || sequence >= next_sequence_ + kMaxAhead) return;
  poses_.emplace(sequence, pose);
  work_off_in_order();
}

void MapperService::on_keyframe(const egraph::Keyframe& keyframe) {
  if (is_my_session(keyframe.header.session, messages::channels::kKeyframe)) queue_.announce(keyframe.id);
}

void MapperService::on_correction(const tracking::PoseCorrection& correction) {
  if (!is_my_session(correction.session, messages::channels::kPoseCorrection) || !corrections_.take(correction)) return;
  map_.correct(correction);
  note(messages::channels::kPoseCorrection, correction);
  work_off_in_order();
}

void MapperService::work_off_in_order() {
  for (;; ++next_sequence_) {
    const auto frame = frames_.find(next_sequence_);
    const auto pose = poses_.find(next_sequence_);
    if (frame == frames_.end() || pose == poses_.end() || !corrections_.has(pose->second.corrections)) break;
    integrate(frame->second, pose->second);
    frames_.erase(frame);
    poses_.erase(pose);
  }
  if (next_sequence_ > acknowledged_) acknowledge_finished();
}

void MapperService::integrate(const messages::CompressedFrame& frame, const tracking::PoseEstimate& pose) {
  if (!is_mapped(pose) || map_.contains(pose.keyframe)) return;
  const auto start = std::chrono::steady_clock::now();
  if (const base::Status done = map_.integrate(pose.keyframe, frame, pose.world_from_camera); !done) {
    return context_.status().count_rejected(std::string(messages::channels::kRgbd) + ": " + done.error().message);
  }
  note(messages::channels::kRgbd, frame);
  note(messages::channels::kPose, pose);
  context_.status().count_frame(
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
}

void MapperService::finish_keyframe(const messages::CompressedFrame& frame, const tracking::PoseEstimate& pose) {
  integrate(frame, pose);
  queue_.finish(pose.keyframe);
}

void MapperService::request_missing(std::int64_t now_utime) {
  const std::int64_t given_up = queue_.given_up();
  const KeyframeQueue::Missing missing = queue_.to_request(now_utime);
  request(messages::channels::kPose, missing.poses);
  request(messages::channels::kRgbd, missing.frames);
  if (const auto have = corrections_.to_request(now_utime)) request(messages::channels::kPoseCorrection, {*have});
  context_.status().count_dropped(queue_.given_up() - given_up);
}

void MapperService::request(const char* channel, const std::vector<std::int64_t>& numbers) {
  if (!numbers.empty())
    context_.publish(messages::channels::kResend, messages::ResendRequest{*session_, channel, numbers});
}

void MapperService::acknowledge_finished() {
  acknowledged_ = next_sequence_;
  const messages::Acknowledge done{*session_, next_sequence_ - 1, with_share(context_.options().name)};
  note(messages::channels::kAcknowledge, done);
  context_.publish(messages::channels::kAcknowledge, done);
}

void MapperService::idle(std::int64_t now_utime) {
  map_.move_next();
  if (!session_) return;
  request_missing(now_utime);
  for (const mapping::MeshChunk& chunk : mesh_stream_.next(map_.field(), *session_, now_utime)) {
    context_.publish(messages::channels::kMeshChunk, chunk);
  }
}

base::Status MapperService::save() {
  const std::filesystem::path& out = context_.options().out;
  if (out.empty()) return {};
  map_.settle();
  const std::string name = with_share("mesh");
  if (const auto mesh = write_mesh(out / name, map_.field().extract_mesh()); !mesh) return mesh;
  const base::Status vdb = io::write_file_atomically(
      out / (name + ".vdb"), [this](std::ostream& file) { return map_.field().write_vdb(file); });
  return vdb ? save_archive() : vdb;
}

base::Status MapperService::save_archive() const {
  const std::filesystem::path folder = service::archive_folder(context_.options().out);
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) return base::fail(folder.string() + ": cannot be made: " + failure.message());
  return save_dense_archive(folder / (with_share(service::kDenseMapName) + ".map"), map_);
}

}  // namespace eg::services
