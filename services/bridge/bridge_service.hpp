#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "common/egraph/graph.hpp"
#include "common/egraph/snapshot_parts.hpp"
#include "common/messages/bot.hpp"
#include "common/service/correction_follower.hpp"
#include "common/service/service.hpp"
#include "services/bridge/cloud_map.hpp"

namespace eg::services {

/// Says what E-Graph SLAM computes in the types that robots and viewers of the LCM world know: POSE as bot_core.pose_t
/// on POSE_BODY, keyframes and the edges of the E-Graph as vs collections on OBJECT_COLLECTION and LINK_COLLECTION, the
/// vertices of the mesh, thinned, as bot_core.pointcloud2_t on MAP_CLOUD.
///
/// Their frames: x forward, y left, z up, both of the body (the camera) and of the world (the first keyframe). New
/// keyframes and corrected ones are sent at once, all of them again every few seconds for viewers that come late.
class BridgeService : public service::Service {
 public:
  explicit BridgeService(service::ServiceContext& context);

  void idle(std::int64_t now_utime) override;

 private:
  /// What is known of a recording or robot.
  struct Session {
    std::map<std::int32_t, geometry::Pose> keyframes;  ///< by id, world_from_camera
    std::map<std::int32_t, std::int64_t> versions;     ///< of the corrections that moved them
    egraph::Graph graph;                               ///< replica: its edges follow from what keyframes saw
    egraph::SnapshotAssembler snapshot;
    std::set<std::pair<std::int32_t, std::int32_t>> edges;  ///< between keyframes
    service::CorrectionFollower corrections;                ///< which of them have come
    CloudMap cloud;
  };

  void on_pose(const tracking::PoseEstimate& pose);
  void on_keyframe(const egraph::Keyframe& keyframe);
  void on_correction(const tracking::PoseCorrection& correction);
  void on_update(const egraph::GraphUpdate& update);
  void on_snapshot(const egraph::GraphSnapshot& part);
  void on_chunk(const mapping::MeshChunk& chunk);
  /// Remembers them; returns those that are new, as many as fit into a message.
  static messages::bot::LinkCollection add_edges(std::int64_t number, std::span<const egraph::Edge> edges,
                                                 Session& session);
  /// The session's record; null if there are too many already.
  Session* session(std::int64_t number);
  void send_all(std::int64_t number, const Session& session);
  void send_cloud(std::int64_t number, const CloudMap& map);

  service::ServiceContext& context_;
  std::map<std::int64_t, Session> sessions_;
  std::int64_t last_round_ = 0;
};

}  // namespace eg::services
