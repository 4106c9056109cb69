#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/service/service.hpp"
#include "services/frame_source/frame_input.hpp"
#include "services/frame_source/frame_store.hpp"
#include "services/frame_source/lockstep_window.hpp"
#include "services/frame_source/read_ahead.hpp"
#include "services/frame_source/realtime_pacer.hpp"

namespace eg::services {

struct FrameSourceOptions {
  InputOptions input;
  std::vector<std::string> consumers = {"tracker", "mapper"};  ///< services that acknowledge frames
  LockstepWindow::Options window;
};

/// Says what is wrong with the options.
base::Status validate(const FrameSourceOptions& options, bool lockstep);

/// Publishes the frames of a recording, a log or a synthetic scene as RGBD, or as FEATURES if the recording holds
/// those, then END_OF_STREAM until the process is ended.
///
/// Lockstep: a few frames ahead of the consumers' acknowledgements, each until all have acknowledged it.
/// Real time: by the recording's time stamps, from when all consumers are there. The frames of the last ten seconds are
/// sent again to who asks for them.
/// Frames that cannot be read are logged and left out; END_OF_STREAM lists them.
class FrameSourceService : public service::Service {
 public:
  FrameSourceService(service::ServiceContext& context, const FrameSourceOptions& options,
                     std::unique_ptr<FrameInput> input);

  void idle(std::int64_t now_utime) override;

  /// Writes groundtruth.txt if the input makes its own poses.
  base::Status save() override;

 private:
  void run_lockstep(std::int64_t now_utime);
  void run_realtime(std::int64_t now_utime);
  /// The next readable frame, with its header complete, if there is one yet.
  std::optional<SourceFrame> next_frame();
  void send(const SourceFrame& frame);
  void publish(const SourceFrame& frame);
  void announce_end(std::int64_t now_utime);

  service::ServiceContext& context_;
  std::int64_t session_;
  std::shared_ptr<const FrameInput> input_;
  LockstepWindow window_;
  RealtimePacer pacer_;
  FrameStore store_;                    ///< real time
  std::optional<SourceFrame> waiting_;  ///< real time: read, not yet due
  std::int64_t sent_ = 0;
  std::vector<std::int64_t> skipped_utimes_;
  std::int64_t now_utime_ = 0;
  std::optional<std::int64_t> end_announced_;  ///< when last
  ReadAhead reader_;
};

}  // namespace eg::services
