#include "services/viewer/viewer_service.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "common/messages/channels.hpp"
#include "common/messages/service_name.hpp"
#include "services/viewer/arrays.hpp"
#include "services/viewer/keyframe_contents.hpp"
#include "services/viewer/packet.hpp"

namespace eg::services {
namespace {

namespace channels = messages::channels;

// Microseconds between two pictures of each kind. Faster than an eye sees would only cost.
constexpr std::int64_t kMovingPeriod = 50'000;
constexpr std::int64_t kLivePeriod = 100'000;
constexpr std::int64_t kStructurePeriod = 500'000;
constexpr std::int64_t kSlowPeriod = 1'000'000;
constexpr std::int64_t kRequestPeriod = 3'000'000;
constexpr std::int64_t kSessionSilent = 3'000'000;

/// A source sends a few frames again at most; a sequence number further back is another run.
constexpr std::int64_t kAnotherRun = 64;
constexpr int kStreamQueue = 16;
constexpr std::size_t kMaxPending = 64;
constexpr std::size_t kMegabyte = 1'000'000;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Whether `now` has reached `next`, which then moves on.
bool is_due(std::int64_t& next, std::int64_t now, std::int64_t period) {
  if (now < next) return false;
  next = now + period;
  return true;
}

StoredImage stored(const messages::CompressedFrame& frame) {
  const bool jpeg = frame.colour_encoding == codec::ColourEncoding::jpeg;
  return {jpeg ? "image/jpeg" : "image/png", frame.colour};
}

}  // namespace

base::Result<std::unique_ptr<ViewerService>> ViewerService::make(service::ServiceContext& context,
                                                                 const ViewerOptions& options) {
  auto page = load_page(options.page);
  if (!page) return tl::make_unexpected(page.error());
  std::unique_ptr<ViewerService> service(new ViewerService(context, options));
  auto web = WebServer::start(options.web, std::move(*page), service->board_, service->images_);
  if (!web) return tl::make_unexpected(web.error());
  service->web_ = std::move(*web);
  service->subscribe();
  return service;
}

ViewerService::ViewerService(service::ServiceContext& context, const ViewerOptions& options)
    : context_(context),
      board_(static_cast<std::size_t>(options.scene_budget) * kMegabyte),
      images_(static_cast<std::size_t>(options.image_budget) * kMegabyte),
      mesh_(board_),
      ground_truth_(options.ground_truth) {
  restart(0);
  session_.reset();
}

void ViewerService::subscribe() {
  context_.subscribe<messages::CompressedFrame>(channels::kRgbd, kStreamQueue,
                                                [this](const messages::CompressedFrame& frame) { recent_.add(frame); });
  context_.subscribe<features::FrameFeatures>(channels::kFeatures, kStreamQueue,
                                              [this](const features::FrameFeatures& frame) { recent_.add(frame); });
  context_.subscribe<features::FrameFeatures>(channels::kKeyframeFeatures, kStreamQueue,
                                              [this](const features::FrameFeatures& frame) { on_missed(frame); });
  context_.subscribe<tracking::PoseEstimate>(channels::kPose, service::kSmallQueue,
                                             [this](const tracking::PoseEstimate& pose) { on_pose(pose); });
  context_.subscribe<egraph::GraphUpdate>(channels::kGraphUpdate, service::kStateQueue,
                                          [this](const egraph::GraphUpdate& update) {
                                            if (is_shown(update.session)) graph_incomplete_ = !graph_.apply(update);
                                          });
  context_.subscribe<egraph::GraphSnapshot>(channels::kGraphSnapshot, service::kStateQueue,
                                            [this](const egraph::GraphSnapshot& graph) {
                                              if (is_shown(graph.session) && graph_.apply(graph))
                                                graph_incomplete_ = false;
                                            });
  context_.subscribe<tracking::PoseCorrection>(channels::kPoseCorrection, service::kStateQueue,
                                               [this](const tracking::PoseCorrection& correction) {
                                                 if (is_shown(correction.session)) graph_.apply(correction);
                                               });
  context_.subscribe<mapping::MeshChunk>(channels::kMeshChunk, service::kStateQueue,
                                         [this](const mapping::MeshChunk& chunk) {
                                           if (!is_shown(chunk.session)) return;
                                           if (mesh_state_ == Mesh::asked_for) mesh_state_ = Mesh::coming;
                                           check(mesh_.add(chunk));
                                         });
  context_.subscribe<messages::ServiceStatus>(channels::kStatus, service::kSmallQueue,
                                              [this](const messages::ServiceStatus& status) { on_status(status); });
}

bool ViewerService::is_shown(std::int64_t session) {
  if (!session_) session_ = session;
  return session == *session_;
}

void ViewerService::on_missed(const features::FrameFeatures& frame) {
  if (!session_ || frame.header.session != *session_) return;
  if (const auto keyframe = missed_.find(graph_.graph(), frame.header.sequence)) add_contents(*keyframe, frame);
}

void ViewerService::on_pose(const tracking::PoseEstimate& pose) {
  const auto start = std::chrono::steady_clock::now();
  follow_session(pose.header);
  if (!is_shown(pose.header.session)) return;
  heard_pose_ = now_;
  context_.status().count_sequence(pose.header.session, pose.header.sequence);
  if (pose.keyframe.valid() && pose.has_pose) add_keyframe(pose);
  trajectory_.add(pose, graph_);
  latest_pose_ = pose;
  context_.status().count_frame(milliseconds_since(start));
}

void ViewerService::follow_session(const image::FrameHeader& header) {
  if (!session_) return;
  const bool another = header.session != *session_ && now_ - heard_pose_ > kSessionSilent;
  const bool again = header.session == *session_ && header.sequence + kAnotherRun < trajectory_.newest_sequence();
  if (another || again) restart(header.session);
}

void ViewerService::restart(std::int64_t session) {
  session_ = session;
  ++runs_;
  graph_.clear();
  mesh_.clear();
  planes_.clear();
  trajectory_.clear();
  missed_.clear();
  images_.clear();
  pending_contents_.clear();
  latest_pose_.reset();
  live_sequence_ = -1;
  graph_incomplete_ = true;
  mesh_state_ = Mesh::missing;
  board_.restart("scene", Packet("scene").set("run", static_cast<double>(runs_)).bytes());
}

void ViewerService::add_keyframe(const tracking::PoseEstimate& pose) {
  graph_.add_keyframe(pose.keyframe, pose.world_from_camera);
  if (const auto* frame = recent_.find_frame(pose.header)) {
    images_.put(pose.keyframe.value, stored(*frame));
  }
  if (const auto* features = recent_.find_features(pose.header)) add_contents(pose.keyframe, *features);
}

void ViewerService::add_contents(egraph::KeyframeId keyframe, const features::FrameFeatures& features) {
  if (!pending_contents_.try_emplace(keyframe, features).second) return;
  missed_.note_seen(keyframe);
  planes_.add(keyframe, features.planes);
  camera_ = features.camera;
  if (pending_contents_.size() > kMaxPending) pending_contents_.erase(pending_contents_.begin());
}

void ViewerService::put_live() {
  const tracking::PoseEstimate& pose = *latest_pose_;
  live_sequence_ = pose.header.sequence;
  const LiveFrame live{recent_.find_frame(pose.header), recent_.find_features(pose.header), &pose};
  if (live.frame != nullptr || live.features != nullptr)
    check(board_.put("live", live_.packet(live, graph_.colours())));
}

void ViewerService::on_status(const messages::ServiceStatus& status) {
  const bool restarted = health_.add(status, now_);
  if (restarted && messages::is_of_service(status.service, "mapper")) mesh_.forget_revisions();
  if (restarted && status.service == "egraph_server") graph_incomplete_ = true;
}

void ViewerService::idle(std::int64_t now_utime) {
  now_ = now_utime;
  if (is_due(next_moving_, now_, kMovingPeriod)) put_moving_parts();
  const bool new_frame = latest_pose_ && latest_pose_->header.sequence != live_sequence_;
  // The one costly picture: nothing of it is made while nobody looks.
  if (new_frame && web_->counts().browsers > 0 && is_due(next_live_, now_, kLivePeriod)) put_live();
  if (is_due(next_structure_, now_, kStructurePeriod)) put_structure();
  if (is_due(next_slow_, now_, kSlowPeriod)) put_slow_parts();
  if (board_.latest() == notified_) return;
  notified_ = board_.latest();
  web_->notify();
}

void ViewerService::put_moving_parts() {
  check(graph_.put_poses(board_));
  trajectory_.take_missed(graph_);
  check(trajectory_.put(board_));
  if (latest_pose_) put_camera();
}

void ViewerService::put_structure() {
  put_pending_contents();
  if (session_) ask_for_contents();
  check(graph_.put_graph(board_));
  check(planes_.put(board_, graph_));
}

void ViewerService::put_slow_parts() {
  check(board_.put("health", health_.packet(now_, latest_pose_ ? now_ - heard_pose_ : 0)));
  if (ground_truth_.is_given()) check(ground_truth_.put(board_, trajectory_.poses(graph_)));
  if (session_ && is_due(next_request_, now_, kRequestPeriod)) ask_for_what_is_missing();
}

void ViewerService::put_camera() {
  const tracking::PoseEstimate& pose = *latest_pose_;
  const bool y_up = camera_.fy < 0.0;
  std::vector<float> numbers, up;
  append_pose(numbers, pose.world_from_camera);
  append(up, graph_.up(y_up));
  Packet packet("camera");
  packet.set("session", static_cast<double>(pose.header.session))
      .set("sequence", static_cast<double>(pose.header.sequence))
      .set("state", tracking::to_string(pose.state))
      .set("reason", pose.reason)
      .set_flag("has_pose", pose.has_pose)
      .set_flag("mirrored", y_up)
      .set("width", camera_.width)
      .set("height", camera_.height)
      .set("fx", camera_.fx)
      .set("fy", camera_.fy)
      .set("cx", camera_.cx)
      .set("cy", camera_.cy)
      .set("reference", pose.rotation_reference.value)
      .set("points", pose.matched_points)
      .set("lines", pose.matched_lines)
      .set("planes", pose.matched_planes)
      .set("directions", pose.matched_directions)
      .array("pose", numbers)
      .array("up", up);
  check(board_.put("camera", packet.bytes()));
}

void ViewerService::put_pending_contents() {
  for (auto it = pending_contents_.begin(); it != pending_contents_.end();) {
    const auto& [id, features] = *it;
    const geometry::Pose* pose = graph_.find_pose(id);
    if (pose != nullptr) {
      check(board_.put(fmt::format("contents/{}", id.value), contents_packet(id, features, *pose, graph_.colours())));
    }
    // Lines get their colours when the graph has the keyframe's directions.
    it = graph_.graph().find_keyframe(id) != nullptr ? pending_contents_.erase(it) : std::next(it);
  }
}

void ViewerService::ask_for_what_is_missing() {
  if (graph_incomplete_) {
    context_.publish(channels::kGraphRequest, messages::GraphRequest{*session_, graph_.graph().version()});
  }
  if (mesh_state_ == Mesh::coming) return;
  mesh_state_ = Mesh::asked_for;
  context_.publish(channels::kMeshRequest, messages::MeshRequest{*session_});
}

void ViewerService::ask_for_contents() {
  const std::vector<std::int64_t> keyframes = missed_.next(graph_.graph());
  if (keyframes.empty()) return;
  context_.publish(channels::kResend, messages::ResendRequest{*session_, channels::kKeyframeFeatures, keyframes});
}

void ViewerService::check(bool put) {
  if (!put) context_.status().count_rejected("the scene is larger than the viewer keeps; raise scene_budget");
}

}  // namespace eg::services
