#include "services/bridge/bridge_service.hpp"

#include <string>

#include "common/messages/channels.hpp"

namespace eg::services {
namespace {

using messages::bot::BodyPose;
using messages::bot::LinkCollection;
using messages::bot::ObjectCollection;

constexpr char kBodyPose[] = "POSE_BODY";
constexpr char kObjects[] = "OBJECT_COLLECTION";
constexpr char kLinks[] = "LINK_COLLECTION";
constexpr char kCloud[] = "MAP_CLOUD";

constexpr std::size_t kMaxSessions = 64;
constexpr std::size_t kMaxItems = 2000;     // of a message: 128 kB
constexpr std::size_t kMaxObservers = 200;  // edges go to the oldest that saw a landmark: nobody tells more lines apart
constexpr std::int64_t kRound = 3'000'000;  // microseconds
constexpr int kPoseQueue = 2;               // the newest counts

/// From axes x right, y down, z forward to x forward, y left, z up.
const geometry::Pose kBodyFromCamera = {(Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished(),
                                        Eigen::Vector3d::Zero()};

/// The camera's pose as that of a body whose x axis looks forward and whose z axis points up, in such a world.
geometry::Pose body_pose(const geometry::Pose& world_from_camera) {
  return kBodyFromCamera * world_from_camera * kBodyFromCamera.inverse();
}

std::int32_t objects_id(std::int64_t session) { return static_cast<std::int32_t>(2 * (session % 1'000'000)); }

ObjectCollection keyframe_collection(std::int64_t session) {
  return {objects_id(session), "keyframes of session " + std::to_string(session), {}};
}

LinkCollection edge_collection(std::int64_t session) {
  return {objects_id(session) + 1, "E-Graph of session " + std::to_string(session), objects_id(session), {}};
}

ObjectCollection::Object object(std::int32_t keyframe, const geometry::Pose& world_from_camera) {
  return {keyframe, body_pose(world_from_camera)};
}

/// Links need numbers that stay the same when they are sent again.
LinkCollection::Link link(std::int32_t first, std::int32_t second) {
  return {(static_cast<std::int64_t>(first) << 32U) + second, first, second};
}

}  // namespace

BridgeService::BridgeService(service::ServiceContext& context) : context_(context) {
  namespace channels = messages::channels;
  context_.subscribe<tracking::PoseEstimate>(channels::kPose, kPoseQueue, [this](const auto& pose) { on_pose(pose); });
  context_.subscribe<egraph::Keyframe>(channels::kKeyframe, service::kStateQueue,
                                       [this](const auto& keyframe) { on_keyframe(keyframe); });
  context_.subscribe<tracking::PoseCorrection>(channels::kPoseCorrection, service::kStateQueue,
                                               [this](const auto& correction) { on_correction(correction); });
  context_.subscribe<egraph::GraphUpdate>(channels::kGraphUpdate, service::kStateQueue,
                                          [this](const auto& update) { on_update(update); });
  context_.subscribe<mapping::MeshChunk>(channels::kMeshChunk, service::kStateQueue,
                                         [this](const auto& chunk) { on_chunk(chunk); });
  context_.subscribe<egraph::GraphSnapshot>(channels::kGraphSnapshot, service::kStateQueue,
                                            [this](const auto& part) { on_snapshot(part); });
}

BridgeService::Session* BridgeService::session(std::int64_t number) {
  if (!sessions_.contains(number) && sessions_.size() >= kMaxSessions) return nullptr;
  return &sessions_[number];
}

void BridgeService::on_pose(const tracking::PoseEstimate& pose) {
  if (Session* known = session(pose.header.session)) known->corrections.announce(pose.corrections);
  if (!pose.has_pose) return;
  context_.publish(kBodyPose, BodyPose{pose.header.utime, body_pose(pose.world_from_camera)});
  context_.status().count_frame(0.0);
}

void BridgeService::on_keyframe(const egraph::Keyframe& keyframe) {
  Session* known = session(keyframe.header.session);
  if (known == nullptr || !known->keyframes.try_emplace(keyframe.id.value, keyframe.world_from_camera).second) return;
  ObjectCollection collection = keyframe_collection(keyframe.header.session);
  collection.objects.push_back(object(keyframe.id.value, keyframe.world_from_camera));
  context_.publish(kObjects, collection);
}

void BridgeService::on_correction(const tracking::PoseCorrection& correction) {
  Session* known = session(correction.session);
  if (known == nullptr || !known->corrections.take(correction)) return;
  ObjectCollection collection = keyframe_collection(correction.session);
  for (const auto& [keyframe, world_from_camera] : correction.entries) {
    std::int64_t& version = known->versions[keyframe.value];
    if (correction.version < version) continue;
    version = correction.version;
    known->keyframes[keyframe.value] = world_from_camera;
    if (collection.objects.size() < kMaxItems) collection.objects.push_back(object(keyframe.value, world_from_camera));
  }
  context_.publish(kObjects, collection);
}

void BridgeService::on_update(const egraph::GraphUpdate& update) {
  Session* known = session(update.session);
  if (known == nullptr) return;
  if (!known->graph.apply(update)) {
    context_.publish(messages::channels::kGraphRequest, messages::GraphRequest{update.session, known->graph.version()});
    return;
  }
  const auto edges = known->graph.edges_to_older(update.keyframe.id, kMaxObservers);
  const LinkCollection collection = add_edges(update.session, edges, *known);
  if (!collection.links.empty()) context_.publish(kLinks, collection);
}

void BridgeService::on_snapshot(const egraph::GraphSnapshot& part) {
  Session* known = session(part.session);
  if (known == nullptr || part.version <= known->graph.version()) return;
  const auto snapshot = known->snapshot.add(part);
  if (!snapshot || !known->graph.reset(*snapshot)) return;
  const LinkCollection collection = add_edges(part.session, known->graph.edges(kMaxObservers), *known);
  if (!collection.links.empty()) context_.publish(kLinks, collection);
}

LinkCollection BridgeService::add_edges(std::int64_t number, std::span<const egraph::Edge> edges, Session& session) {
  LinkCollection collection = edge_collection(number);
  for (const egraph::Edge& edge : edges) {
    if (!session.edges.emplace(edge.first.value, edge.second.value).second) continue;
    if (collection.links.size() < kMaxItems) collection.links.push_back(link(edge.first.value, edge.second.value));
  }
  return collection;
}

void BridgeService::on_chunk(const mapping::MeshChunk& chunk) {
  if (Session* known = session(chunk.session)) known->cloud.add(chunk);
}

void BridgeService::idle(std::int64_t now_utime) {
  for (auto& [number, known] : sessions_) {
    const auto have = known.corrections.to_request(now_utime);
    if (!have) continue;
    const messages::ResendRequest request{number, messages::channels::kPoseCorrection, {*have}};
    context_.publish(messages::channels::kResend, request);
  }
  if (now_utime - last_round_ < kRound) return;
  last_round_ = now_utime;
  for (const auto& [number, known] : sessions_) send_all(number, known);
}

void BridgeService::send_all(std::int64_t number, const Session& known) {
  ObjectCollection objects = keyframe_collection(number);
  for (const auto& [keyframe, world_from_camera] : known.keyframes) {
    objects.objects.push_back(object(keyframe, world_from_camera));
    if (objects.objects.size() < kMaxItems) continue;
    context_.publish(kObjects, objects);
    objects.objects.clear();
  }
  if (!objects.objects.empty()) context_.publish(kObjects, objects);
  LinkCollection links = edge_collection(number);
  for (const auto& [first, second] : known.edges) {
    links.links.push_back(link(first, second));
    if (links.links.size() < kMaxItems) continue;
    context_.publish(kLinks, links);
    links.links.clear();
  }
  if (!links.links.empty()) context_.publish(kLinks, links);
  if (!known.cloud.empty()) send_cloud(number, known.cloud);
}

void BridgeService::send_cloud(std::int64_t number, const CloudMap& map) {
  messages::bot::PointCloud cloud = map.cloud();
  cloud.frame = "map of session " + std::to_string(number);
  const Eigen::Matrix3f rotation = kBodyFromCamera.rotation.cast<float>();
  for (auto& point : cloud.points) point.position = rotation * point.position;
  context_.publish(kCloud, cloud);
}

}  // namespace eg::services
