#pragma once

#include <vector>

#include "common/egraph/graph_builder.hpp"
#include "common/messages/channels.hpp"
#include "services/tracker/tracker_service.hpp"
#include "tests/support/bus_peer.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::services {

namespace channels = messages::channels;
using features::FrameFeatures;
using tracking::PoseEstimate;

/// A short recording, made once.
inline const test::FeatureSequence& recording() {
  static const test::FeatureSequence sequence = [] {
    const geometry::CameraModel camera = *geometry::find_camera("tum_fr3");
    std::vector<geometry::Pose> poses;
    for (int i = 0; i < 40; ++i) {
      poses.push_back(test::looking_at({0.02 * i - 0.4, 0, -0.5}, {0.03 * i, 0.3, 2}, camera));
    }
    return test::record(test::make_room(), camera, poses, 1);
  }();
  return sequence;
}

inline const FrameFeatures& frame(std::size_t index) { return recording().frames[index]; }

/// The tracker on a bus, with a peer in place of source, server and viewers.
class Rig {
 public:
  /// `out`: empty for a folder of its own and no journal.
  explicit Rig(bool lockstep, const transport::MemoryNetwork::Disturbance& disturbance = {},
               const std::filesystem::path& out = {}, std::uint64_t most_journal_bytes = kMostJournalBytes)
      : out_(out.empty() ? folder_.path() : out),
        network_(std::make_shared<transport::MemoryNetwork>(disturbance)),
        bus_(network_),
        peer_(network_),
        context_(bus_, options(lockstep)),
        service_(context_, tracking::TrackerOptions{}),
        poses(peer_.collect<PoseEstimate>(channels::kPose)),
        acknowledged(peer_.collect<messages::Acknowledge>(channels::kAcknowledge)),
        keyframes(peer_.collect<egraph::Keyframe>(channels::kKeyframe)),
        requests(peer_.collect<messages::GraphRequest>(channels::kGraphRequest)) {
    if (out.empty()) return;
    const auto resumed = service_.resume(most_journal_bytes);
    EXPECT_TRUE(resumed) << resumed.error().message;
  }

  template <typename T>
  void send(const char* channel, const T& value) {
    peer_.send(channel, value);
    settle();
  }
  void send_bytes(const char* channel, const messages::Bytes& bytes) {
    peer_.send_bytes(channel, bytes);
    settle();
  }
  /// What comes over another channel from now on.
  template <typename T>
  test::Inbox<T> collect(const char* channel) {
    return peer_.collect<T>(channel);
  }
  void send_frame(std::size_t index) { send(channels::kFeatures, frame(index)); }

  /// Answers, as the server does, every keyframe that has arrived since the last call.
  void answer_keyframes() {
    for (; answered_ < keyframes->size(); ++answered_) {
      const auto update = builder.add_keyframe((*keyframes)[answered_]);
      if (update) peer_.send(channels::kGraphUpdate, *update);
    }
    settle();
  }

  void idle(std::int64_t utime) {
    service_.idle(utime);
    settle();
  }

  base::Status save() { return service_.save(); }
  base::Status load(const std::filesystem::path& archive) { return service_.load(archive); }
  [[nodiscard]] messages::ServiceStatus status() { return context_.status().status(0); }
  [[nodiscard]] const std::filesystem::path& folder() const { return out_; }

  /// The sequence numbers of the poses so far.
  [[nodiscard]] std::vector<std::int64_t> order() const {
    std::vector<std::int64_t> sequences;
    for (const PoseEstimate& pose : *poses) sequences.push_back(pose.header.sequence);
    return sequences;
  }

 private:
  service::ServiceOptions options(bool lockstep) const {
    service::ServiceOptions options;
    options.name = "tracker";
    options.out = out_;
    options.lockstep = lockstep;
    return options;
  }
  void settle() {
    while (bus_.handle(std::chrono::milliseconds(0)).value_or(0) + peer_.handle() > 0) {
    }
  }

  test::TemporaryFolder folder_;
  std::filesystem::path out_;
  std::shared_ptr<transport::MemoryNetwork> network_;
  transport::MemoryBus bus_;
  test::BusPeer peer_;
  service::ServiceContext context_;
  TrackerService service_;
  std::size_t answered_ = 0;

 public:
  test::Inbox<PoseEstimate> poses;
  test::Inbox<messages::Acknowledge> acknowledged;
  test::Inbox<egraph::Keyframe> keyframes;
  test::Inbox<messages::GraphRequest> requests;
  egraph::GraphBuilder builder;
};

}  // namespace eg::services
