#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/service/message_journal.hpp"
#include "common/service/service.hpp"
#include "services/mapper/mapped_session.hpp"

namespace eg::services {

/// RGBD, FEATURES, POSE, KEYFRAME, POSE_CORRECTION and MESH_REQUEST in; MESH_CHUNK out; mesh.ply and mesh.vdb at the
/// end.
///
/// Every keyframe that was tracked in all six degrees of freedom is fused with the pose that its POSE message carries,
/// its depth regularised by the planes of its FEATURES (unless MapperOptions::plane_regularisation is off).
/// Lockstep: frames are worked off strictly in order, each once its messages and all corrections before it are there,
/// and then acknowledged; one that comes again is acknowledged again. Real time: the latest frames are kept until their
/// pose comes; what a keyframe lacks, its pose, images or features, is asked for by RESEND. A keyframe that nobody has
/// any more is counted as dropped in the status.
///
/// With an output folder, everything that goes into the map is also written into the journal there, and a mapper that
/// was killed goes on from it (`resume`); and what the map has no memory for (`memory_mb`) waits there. Mappers that
/// share the space (TsdfOptions::shares) report and acknowledge as "mapper.0", "mapper.1" and so on, and write
/// mesh.0.ply, mesh.1.ply and so on.
///
/// One session at a time. What comes of another one begins a new map when the one before has ended, or nothing was
/// heard of it for some seconds; its results are then saved to session-<id>/ within the output folder.
class MapperService : public service::Service {
 public:
  /// `options` must be valid.
  MapperService(service::ServiceContext& context, const MapperOptions& options);

  /// Once, before the first message. `archive`: of an earlier session, to go on in; empty: none. Fails if the archive
  /// is damaged or was made with other options, or if the journal cannot be written or, to be resumed, is damaged.
  base::Status open(const std::filesystem::path& archive);

  void idle(std::int64_t now_utime) override;

  /// Writes mesh.ply, mesh.vdb and the dense part of the map archive, with every keyframe at its latest pose.
  base::Status save() override;

 private:
  void on_frame(const messages::CompressedFrame& frame);
  void on_features(const features::FrameFeatures& features);
  void on_pose(const tracking::PoseEstimate& pose);
  void on_keyframe(const egraph::Keyframe& keyframe);
  void on_correction(const tracking::PoseCorrection& correction);
  void on_end_of_stream(const messages::EndOfStream& end);

  /// Makes it the session being mapped, unless another one goes on. Whether it is; if not, that is counted.
  bool enter_session(std::int64_t id, const char* channel);
  void leave_session();
  base::Status begin_journal(bool resume);
  void stop_journal(const base::Error& error);

  void work_off_in_order();
  /// Whether all that the map needs of a frame with that pose is there.
  [[nodiscard]] bool is_complete(const FrameParts& parts, const tracking::PoseEstimate& pose) const;
  void integrate(const FrameParts& parts, const tracking::PoseEstimate& pose);
  // Real time:
  void take_pose(const tracking::PoseEstimate& pose);
  void finish_if_complete(std::int64_t sequence);
  void forget_old_frames();
  void request_missing(std::int64_t now_utime);
  void request(const char* channel, const std::vector<std::int64_t>& numbers);
  void send_mesh(std::int64_t now_utime);
  /// Keeps the map within its memory; what goes wrong is reported once.
  void keep_budget();
  base::Status replay(const transport::LogEvent& event);
  template <typename T>
  void note(const char* channel, const T& value);
  void acknowledge_finished();

  service::ServiceContext& context_;
  MapperOptions options_;
  std::unique_ptr<MappedSession> session_;
  std::deque<std::int64_t> former_sessions_;
  std::optional<service::MessageJournal> journal_;
  FrameParts replayed_;         ///< the journal's last frame
  std::int64_t now_utime_ = 0;  ///< as idle() was told last
  std::string budget_failure_;  ///< the last one, as long as it lasts
};

}  // namespace eg::services
