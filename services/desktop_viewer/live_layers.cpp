#include "services/desktop_viewer/live_layers.hpp"

#include <string>
#include <utility>

#include "common/messages/channels.hpp"
#include "common/messages/service_name.hpp"

namespace eg::services {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kRequestPeriod = 3'000'000;  ///< microseconds
constexpr std::int64_t kSessionSilent = 3'000'000;
/// A source sends a few frames again at most; a sequence number further back is another run.
constexpr std::int64_t kAnotherRun = 64;
constexpr std::size_t kMaxSamples = 1'000'000;  ///< nine hours at 30 Hz
constexpr std::size_t kMaxTiles = 100'000;
constexpr std::int32_t kMaxParts = 64;
constexpr std::size_t kMaxMappers = 64;  ///< that share the space

constexpr float kPathWidth = 3.0F;  ///< pixels
constexpr char kMesh[] = "mesh";
constexpr char kTrajectory[] = "trajectory";
constexpr char kKeyframes[] = "keyframes";

double seconds(std::int64_t utime) { return 1e-6 * static_cast<double>(utime); }

io::PlyData joined(const std::map<std::int32_t, mapping::Mesh>& parts) {
  io::PlyData shape;
  for (const auto& [number, mesh] : parts) {
    const auto first = static_cast<std::uint32_t>(shape.vertices.size());
    shape.vertices.insert(shape.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    shape.normals.insert(shape.normals.end(), mesh.normals.begin(), mesh.normals.end());
    shape.colours.insert(shape.colours.end(), mesh.colours.begin(), mesh.colours.end());
    for (const auto& [a, b, c] : mesh.triangles) shape.triangles.push_back({first + a, first + b, first + c});
  }
  return shape;
}

}  // namespace

LiveLayers::LiveLayers(service::ServiceContext& context, bool y_up)
    : context_(context), display_from_world_(display_from_world((y_up ? 1.0 : -1.0) * Eigen::Vector3d::UnitY(), y_up)) {
  context_.subscribe<tracking::PoseEstimate>(channels::kPose, service::kSmallQueue,
                                             [this](const tracking::PoseEstimate& pose) { on_pose(pose); });
  context_.subscribe<tracking::PoseCorrection>(
      channels::kPoseCorrection, service::kStateQueue,
      [this](const tracking::PoseCorrection& correction) { on_correction(correction); });
  context_.subscribe<mapping::MeshChunk>(channels::kMeshChunk, service::kStateQueue,
                                         [this](const mapping::MeshChunk& chunk) { on_chunk(chunk); });
  context_.subscribe<messages::ServiceStatus>(channels::kStatus, service::kSmallQueue,
                                              [this](const messages::ServiceStatus& status) { on_status(status); });
}

void LiveLayers::idle(std::int64_t now_utime) {
  now_ = now_utime;
  if (!session_ || any_chunk_ || now_utime < next_request_) return;
  next_request_ = now_utime + kRequestPeriod;
  context_.publish(channels::kMeshRequest, messages::MeshRequest{*session_});
}

void LiveLayers::begin(std::int64_t session) {
  session_ = session;
  newest_sequence_ = -1;
  keyframe_ = {};
  keyframes_.clear();
  samples_.clear();
  poses_changed_ = true;
  for (auto& [number, tile] : tiles_) {
    tile = {};
    changed_tiles_.insert(number);
  }
  any_chunk_ = false;
}

void LiveLayers::on_pose(const tracking::PoseEstimate& pose) {
  const bool shown = session_ == pose.header.session;
  const bool again = shown && pose.header.sequence + kAnotherRun < newest_sequence_;
  if (!shown && session_ && now_ - heard_ <= kSessionSilent) return;
  if (!shown || again) begin(pose.header.session);
  heard_ = now_;
  if (pose.header.sequence <= newest_sequence_) return;  // an answer that is repeated
  newest_sequence_ = pose.header.sequence;
  if (!pose.has_pose) return;
  if (pose.keyframe.valid()) {
    keyframe_ = pose.keyframe;
    keyframes_.insert_or_assign(keyframe_, geometry::StampedPose{seconds(pose.header.utime), pose.world_from_camera});
  }
  const auto reference = keyframes_.find(keyframe_);
  if (reference == keyframes_.end() || samples_.size() >= kMaxSamples) return;
  samples_.push_back(
      {seconds(pose.header.utime), keyframe_, reference->second.world_from_camera.inverse() * pose.world_from_camera});
  poses_changed_ = true;
}

void LiveLayers::on_correction(const tracking::PoseCorrection& correction) {
  if (!session_ || correction.session != *session_) return;
  for (const auto& [keyframe, world_from_camera] : correction.entries) {
    const auto known = keyframes_.find(keyframe);
    if (known != keyframes_.end()) known->second.world_from_camera = world_from_camera;
  }
  poses_changed_ = true;
}

void LiveLayers::on_chunk(const mapping::MeshChunk& chunk) {
  if (!session_) begin(chunk.session);
  const TileNumber number{chunk.tile.x(), chunk.tile.y(), chunk.tile.z()};
  if (chunk.session != *session_ || chunk.parts > kMaxParts) return;
  if (!tiles_.contains(number) && tiles_.size() >= kMaxTiles) return;
  any_chunk_ = true;
  Tile& tile = tiles_[number];
  if (chunk.revision <= tile.shown) return;  // the mapper says again what it has said
  if (chunk.revision != tile.coming) tile.parts.clear();
  tile.coming = chunk.revision;
  tile.parts.insert_or_assign(chunk.part, chunk.mesh);
  if (tile.parts.size() < static_cast<std::size_t>(chunk.parts)) return;
  tile = {chunk.revision, -1, {}, joined(tile.parts)};
  to_display(display_from_world_, tile.shape);
  changed_tiles_.insert(number);
}

void LiveLayers::on_status(const messages::ServiceStatus& status) {
  if (!messages::is_of_service(status.service, "mapper")) return;
  if (!mappers_.contains(status.service) && mappers_.size() >= kMaxMappers) return;
  if (std::exchange(mappers_[status.service], status.pid) == status.pid) return;
  for (auto& [number, tile] : tiles_) tile.shown = tile.coming = -1;  // another one counts its revisions from the start
}

std::vector<Layer> LiveLayers::take_changes() {
  std::vector<Layer> changes;
  for (const TileNumber& number : changed_tiles_) {
    const auto tile = tiles_.find(number);
    const std::string part =
        std::to_string(number[0]) + " " + std::to_string(number[1]) + " " + std::to_string(number[2]);
    changes.push_back({kMesh, part, std::move(tile->second.shape)});
    tile->second.shape = {};
    if (changes.back().shape.vertices.empty()) tiles_.erase(tile);
  }
  changed_tiles_.clear();
  if (!std::exchange(poses_changed_, false)) return changes;
  std::vector<geometry::StampedPose> path, keyframes;
  for (const Sample& sample : samples_) {
    const geometry::Pose& world_from_keyframe = keyframes_.at(sample.keyframe).world_from_camera;
    path.push_back({sample.time_s, world_from_keyframe * sample.keyframe_from_camera});
  }
  for (const auto& [id, pose] : keyframes_) keyframes.push_back(pose);
  changes.push_back({kTrajectory, {}, path_shape(path, kTrajectoryColour), kPathWidth});
  changes.push_back({kKeyframes, {}, camera_shape(keyframes, kKeyframeColour)});
  to_display(display_from_world_, changes[changes.size() - 2].shape);
  to_display(display_from_world_, changes.back().shape);
  return changes;
}

}  // namespace eg::services
