#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/service/service.hpp"
#include "services/desktop_viewer/layer.hpp"

namespace eg::services {

/// What a running or replayed system says, as layers: the mesh in its tiles, trajectory and keyframes, corrected when
/// the system corrects them. It watches the first session that it hears of; once that has been silent for three
/// seconds, or its frames begin again from the start, the next. All that it says are requests for the mesh, until some
/// of it has come.
class LiveLayers {
 public:
  /// Subscribes. `y_up`: the camera's fy is negative.
  LiveLayers(service::ServiceContext& context, bool y_up);

  /// Asks for the mesh when that is due. Call it often: it is the clock. `now_utime`: monotonic, microseconds.
  void idle(std::int64_t now_utime);

  /// Layers and parts of them that have changed since the last call; an empty shape: it is no longer there.
  std::vector<Layer> take_changes();

 private:
  struct Sample {
    double time_s = 0.0;
    egraph::KeyframeId keyframe;
    geometry::Pose keyframe_from_camera;
  };
  using TileNumber = std::array<int, 3>;
  struct Tile {
    std::int32_t shown = -1;                        ///< revision of `shape`
    std::int32_t coming = -1;                       ///< revision whose parts are being collected
    std::map<std::int32_t, mapping::Mesh> parts{};  ///< of `coming`
    io::PlyData shape{};
  };

  void on_pose(const tracking::PoseEstimate& pose);
  void on_correction(const tracking::PoseCorrection& correction);
  void on_chunk(const mapping::MeshChunk& chunk);
  void on_status(const messages::ServiceStatus& status);
  void begin(std::int64_t session);

  service::ServiceContext& context_;
  Eigen::Matrix3f display_from_world_;
  std::optional<std::int64_t> session_;
  std::int64_t newest_sequence_ = -1;
  egraph::KeyframeId keyframe_;  ///< the latest
  std::map<egraph::KeyframeId, geometry::StampedPose> keyframes_;
  std::vector<Sample> samples_;
  bool poses_changed_ = false;
  std::map<TileNumber, Tile> tiles_;
  std::set<TileNumber> changed_tiles_;
  bool any_chunk_ = false;
  std::int64_t now_ = 0;    ///< as of the last idle()
  std::int64_t heard_ = 0;  ///< when the session's last pose came
  std::int64_t next_request_ = 0;
  std::map<std::string, std::int32_t> mappers_;  ///< processes, by name: several may share the space
};

}  // namespace eg::services
