#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "common/service/service.hpp"
#include "services/viewer/board.hpp"
#include "services/viewer/graph_view.hpp"
#include "services/viewer/ground_truth.hpp"
#include "services/viewer/health_view.hpp"
#include "services/viewer/keyframe_images.hpp"
#include "services/viewer/live_view.hpp"
#include "services/viewer/mesh_tiles.hpp"
#include "services/viewer/missed_contents.hpp"
#include "services/viewer/plane_map.hpp"
#include "services/viewer/trajectory_view.hpp"
#include "services/viewer/web_server.hpp"

namespace eg::services {

struct ViewerOptions {
  WebOptions web;
  std::filesystem::path page;          ///< folder with index.html
  std::filesystem::path ground_truth;  ///< TUM format; empty: none
  int scene_budget = 512;              ///< MB of packets for the browsers
  int image_budget = 64;               ///< MB of keyframe images
};

/// Watches all streams and shows them to browsers. It takes no part: all that it ever says are requests: for the
/// E-Graph when it has missed an update of it, for the mesh when it begins, for the features of keyframes that it
/// missed.
///
/// It shows one session, the first that it hears of; when that one has fallen silent, or its frames begin again from
/// the start (another run, a log that is played again), the scene begins anew.
class ViewerService : public service::Service {
 public:
  /// Reads the page and starts the web server; an error says what is wrong with either.
  static base::Result<std::unique_ptr<ViewerService>> make(service::ServiceContext& context,
                                                           const ViewerOptions& options);

  void idle(std::int64_t now_utime) override;

  [[nodiscard]] const std::string& url() const { return web_->url(); }

 private:
  ViewerService(service::ServiceContext& context, const ViewerOptions& options);

  void subscribe();
  void on_missed(const features::FrameFeatures& frame);
  void on_pose(const tracking::PoseEstimate& pose);
  void on_status(const messages::ServiceStatus& status);

  [[nodiscard]] bool is_shown(std::int64_t session);
  void follow_session(const image::FrameHeader& header);
  void restart(std::int64_t session);
  void add_keyframe(const tracking::PoseEstimate& pose);
  void add_contents(egraph::KeyframeId keyframe, const features::FrameFeatures& features);

  void put_moving_parts();
  void put_structure();
  void put_slow_parts();
  void put_camera();
  void put_live();
  void put_pending_contents();
  void ask_for_what_is_missing();
  void ask_for_contents();
  void check(bool put);

  service::ServiceContext& context_;
  Board board_;
  KeyframeImages images_;
  GraphView graph_;
  MeshTiles mesh_;
  PlaneMap planes_;
  MissedContents missed_;
  TrajectoryView trajectory_;
  RecentFrames recent_;
  LiveView live_;
  HealthView health_;
  GroundTruth ground_truth_;
  std::map<egraph::KeyframeId, features::FrameFeatures> pending_contents_;  ///< the graph does not know them yet

  std::optional<std::int64_t> session_;
  std::optional<tracking::PoseEstimate> latest_pose_;
  std::int64_t live_sequence_ = -1;  ///< the frame that the 2D panel shows
  geometry::CameraModel camera_;
  bool graph_incomplete_ = true;  ///< an update was missed, or nothing has come yet
  enum class Mesh { missing, asked_for, coming } mesh_state_ = Mesh::missing;
  std::int64_t runs_ = 0;  ///< scenes begun
  std::int64_t now_ = 0;   ///< monotonic, microseconds, as of the last idle()
  std::int64_t heard_pose_ = 0;
  std::int64_t next_moving_ = 0, next_structure_ = 0, next_slow_ = 0, next_live_ = 0, next_request_ = 0;
  std::uint64_t notified_ = 0;
  std::unique_ptr<WebServer> web_;  ///< last: its thread uses the board and the images
};

}  // namespace eg::services
