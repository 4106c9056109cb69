#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/service/correction_follower.hpp"
#include "common/service/message_journal.hpp"
#include "common/service/service.hpp"
#include "services/mapper/keyframe_map.hpp"
#include "services/mapper/keyframe_queue.hpp"
#include "services/mapper/mesh_stream.hpp"

namespace eg::services {

struct MapperOptions {
  mapping::TsdfOptions tsdf;
  int image_budget = 256;    ///< compressed keyframe images kept for corrections, MB
  double mesh_period = 1.0;  ///< seconds between two updates of the mesh on the bus; 0: none
  bool resume = false;       ///< go on from the journal in the output folder
};

/// RGBD, POSE, KEYFRAME, POSE_CORRECTION and MESH_REQUEST in; MESH_CHUNK out; mesh.ply and mesh.vdb at the end.
///
/// Every keyframe that was tracked in all six degrees of freedom is fused with the pose that its POSE message carries.
/// Lockstep: frames are worked off strictly in order, each once both its messages and all corrections before it are
/// there, and then acknowledged; one that comes again is acknowledged again. Real time: the latest frames are kept
/// until their pose comes; what a keyframe lacks, its pose or its images, is asked for by RESEND. A keyframe that
/// nobody has any more is counted as dropped in the status.
///
/// With an output folder, everything that goes into the map is also written into the journal there, and a mapper that
/// was killed goes on from it (`resume`). Mappers that share the space (TsdfOptions::shares) acknowledge as "mapper.0",
/// "mapper.1" and so on, and write mesh.0.ply, mesh.1.ply and so on.
class MapperService : public service::Service {
 public:
  /// `options` must be valid.
  MapperService(service::ServiceContext& context, const MapperOptions& options);

  /// Once, before the first message. Fails if the journal cannot be written or, to be resumed, is damaged.
  base::Status open_journal();

  /// Once, before the journal: goes on in the map archive of an earlier session. Refuses a damaged one and one made
  /// with other options.
  base::Status load(const std::filesystem::path& archive);

  void idle(std::int64_t now_utime) override;

  /// Writes mesh.ply, mesh.vdb and the dense part of the map archive, with every keyframe at its latest pose.
  base::Status save() override;

 private:
  void on_frame(const messages::CompressedFrame& frame);
  void on_pose(const tracking::PoseEstimate& pose);
  void on_keyframe(const egraph::Keyframe& keyframe);
  void on_correction(const tracking::PoseCorrection& correction);

  [[nodiscard]] bool is_my_session(std::int64_t session, const char* channel);
  void work_off_in_order();
  void integrate(const messages::CompressedFrame& frame, const tracking::PoseEstimate& pose);
  void finish_keyframe(const messages::CompressedFrame& frame, const tracking::PoseEstimate& pose);
  void request_missing(std::int64_t now_utime);
  void request(const char* channel, const std::vector<std::int64_t>& numbers);
  base::Status replay(const transport::LogEvent& event);
  template <typename T>
  void note(const char* channel, const T& value);
  /// "mapper" and "mesh", or with the number of this mapper's share behind a dot.
  [[nodiscard]] std::string with_share(const std::string& name) const;
  [[nodiscard]] base::Status save_archive() const;
  void acknowledge_finished();

  service::ServiceContext& context_;
  KeyframeMap map_;
  MeshStream mesh_stream_;
  KeyframeQueue queue_;                                       ///< real time
  service::CorrectionFollower corrections_;                   ///< which of them have come
  std::optional<std::int64_t> session_;                       ///< the first one heard of
  std::int64_t next_sequence_ = 0;                            ///< lockstep: the first frame that is not finished
  std::int64_t acknowledged_ = 0;                             ///< lockstep: next_sequence_ when it was last announced
  std::map<std::int64_t, messages::CompressedFrame> frames_;  ///< by sequence
  std::map<std::int64_t, tracking::PoseEstimate> poses_;      ///< lockstep: by sequence
  bool resume_;
  std::optional<service::MessageJournal> journal_;
  std::optional<messages::CompressedFrame> replayed_;  ///< the journal's last frame
};

}  // namespace eg::services
