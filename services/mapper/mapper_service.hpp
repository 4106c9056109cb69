#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "common/service/service.hpp"
#include "services/mapper/keyframe_map.hpp"
#include "services/mapper/mesh_stream.hpp"

namespace eg::services {

struct MapperOptions {
  mapping::TsdfOptions tsdf;
  int image_budget = 256;    ///< compressed keyframe images kept for corrections, MB
  double mesh_period = 1.0;  ///< seconds between two updates of the mesh on the bus; 0: none
};

/// RGBD, POSE, POSE_CORRECTION and MESH_REQUEST in; MESH_CHUNK out; mesh.ply and mesh.vdb at the end.
///
/// Every keyframe that was tracked in all six degrees of freedom is fused with the pose that its POSE message carries.
/// Lockstep: frames are worked off strictly in order, each once both its messages are there, and then acknowledged; one
/// that comes again is acknowledged again. Real time: the latest frames are kept until their pose comes; a keyframe
/// whose images are gone by then is counted as dropped in the status.
class MapperService : public service::Service {
 public:
  /// `options` must be valid.
  MapperService(service::ServiceContext& context, const MapperOptions& options);

  void idle(std::int64_t now_utime) override;

  /// Writes mesh.ply and mesh.vdb, with every keyframe at its latest pose.
  base::Status save() override;

 private:
  void on_frame(const image::RgbdFrame& frame);
  void on_pose(const tracking::PoseEstimate& pose);
  void on_correction(const tracking::PoseCorrection& correction);

  [[nodiscard]] bool is_my_session(std::int64_t session, const char* channel);
  void work_off_in_order();
  void integrate(const image::RgbdFrame& frame, const tracking::PoseEstimate& pose);
  void acknowledge_finished();

  service::ServiceContext& context_;
  KeyframeMap map_;
  MeshStream mesh_stream_;
  std::optional<std::int64_t> session_;                   ///< the first one heard of
  std::int64_t next_sequence_ = 0;                        ///< lockstep: the first frame that is not finished
  std::int64_t acknowledged_ = 0;                         ///< lockstep: next_sequence_ when it was last announced
  std::map<std::int64_t, image::RgbdFrame> frames_;       ///< by sequence
  std::map<std::int64_t, tracking::PoseEstimate> poses_;  ///< lockstep: by sequence
};

}  // namespace eg::services
