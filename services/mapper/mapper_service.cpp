#include "services/mapper/mapper_service.hpp"

#include <chrono>
#include <sstream>

#include "common/io/atomic_file.hpp"
#include "common/io/ply.hpp"
#include "common/messages/channels.hpp"

namespace eg::services {
namespace {

constexpr std::int64_t kMaxAhead = 16;        // frames in lockstep; the source sends fewer ahead
constexpr std::size_t kMaxRecentFrames = 32;  // one second, in real time: what a pose may take
constexpr int kRealtimeFrameQueue = 8;        // while a keyframe is being fused
constexpr double kMicroseconds = 1e6;
constexpr std::size_t kMegabyte = 1'000'000;

bool is_mapped(const tracking::PoseEstimate& pose) {
  return pose.keyframe.valid() && pose.has_pose && pose.state == tracking::TrackingState::tracking;
}

}  // namespace

MapperService::MapperService(service::ServiceContext& context, const MapperOptions& options)
    : context_(context),
      map_(options.tsdf, static_cast<std::size_t>(options.image_budget) * kMegabyte),
      mesh_stream_(static_cast<std::int64_t>(options.mesh_period * kMicroseconds)) {
  context_.subscribe<image::RgbdFrame>(messages::channels::kRgbd, context_.options().lockstep ? 0 : kRealtimeFrameQueue,
                                       [this](const image::RgbdFrame& frame) { on_frame(frame); });
  context_.subscribe<tracking::PoseEstimate>(messages::channels::kPose, 0,
                                             [this](const tracking::PoseEstimate& pose) { on_pose(pose); });
  context_.subscribe<tracking::PoseCorrection>(
      messages::channels::kPoseCorrection, 0,
      [this](const tracking::PoseCorrection& correction) { on_correction(correction); });
  context_.subscribe<messages::MeshRequest>(messages::channels::kMeshRequest, 30,
                                            [this](const messages::MeshRequest& request) {
                                              if (session_ && request.session == *session_) mesh_stream_.repeat_all();
                                            });
}

bool MapperService::is_my_session(std::int64_t session, const char* channel) {
  if (!session_) session_ = session;
  if (session == *session_) return true;
  context_.status().count_rejected(std::string(channel) + ": field 'session' differs from the session being mapped");
  return false;
}

void MapperService::on_frame(const image::RgbdFrame& frame) {
  if (!is_my_session(frame.header.session, messages::channels::kRgbd)) return;
  const std::int64_t sequence = frame.header.sequence;
  if (!context_.options().lockstep) {
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
  const std::int64_t sequence = pose.header.sequence;
  if (!context_.options().lockstep) {
    const auto frame = frames_.find(sequence);
    if (frame != frames_.end()) integrate(frame->second, pose);
    return;
  }
  if (sequence < next_sequence_ || sequence >= next_sequence_ + kMaxAhead) return;
  poses_.emplace(sequence, pose);
  work_off_in_order();
}

void MapperService::on_correction(const tracking::PoseCorrection& correction) {
  if (is_my_session(correction.session, messages::channels::kPoseCorrection)) map_.correct(correction);
}

void MapperService::work_off_in_order() {
  for (;; ++next_sequence_) {
    const auto frame = frames_.find(next_sequence_);
    const auto pose = poses_.find(next_sequence_);
    if (frame == frames_.end() || pose == poses_.end()) break;
    integrate(frame->second, pose->second);
    frames_.erase(frame);
    poses_.erase(pose);
  }
  if (next_sequence_ > acknowledged_) acknowledge_finished();
}

void MapperService::integrate(const image::RgbdFrame& frame, const tracking::PoseEstimate& pose) {
  if (!is_mapped(pose)) return;
  const auto start = std::chrono::steady_clock::now();
  // Numbers of keyframes, not of frames: a gap is a keyframe that is missing in the map.
  context_.status().count_sequence(pose.header.session, pose.keyframe.value);
  if (const base::Status done = map_.integrate(pose.keyframe, frame, pose.world_from_camera); !done) {
    return context_.status().count_rejected(std::string(messages::channels::kRgbd) + ": " + done.error().message);
  }
  context_.status().count_frame(
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
}

void MapperService::acknowledge_finished() {
  acknowledged_ = next_sequence_;
  context_.publish(messages::channels::kAcknowledge,
                   messages::Acknowledge{*session_, next_sequence_ - 1, context_.options().name});
}

void MapperService::idle(std::int64_t now_utime) {
  map_.move_next();
  if (!session_) return;
  for (const mapping::MeshChunk& chunk : mesh_stream_.next(map_.field(), *session_, now_utime)) {
    context_.publish(messages::channels::kMeshChunk, chunk);
  }
}

base::Status MapperService::save() {
  const std::filesystem::path& out = context_.options().out;
  if (out.empty()) return {};
  map_.settle();
  const mapping::Mesh mesh = map_.field().extract_mesh();
  const base::Status ply = io::write_ply(out / "mesh.ply", io::view_of(mesh));
  if (!ply) return ply;
  std::ostringstream vdb;
  if (const base::Status written = map_.field().write_vdb(vdb); !written) return written;
  return io::write_file_atomically(out / "mesh.vdb", vdb.view());
}

}  // namespace eg::services
