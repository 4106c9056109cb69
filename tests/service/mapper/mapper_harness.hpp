#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "common/features/plane_extraction.hpp"
#include "common/image/rectifier.hpp"
#include "common/io/ply.hpp"
#include "common/messages/channels.hpp"
#include "common/synthetic/sequence.hpp"
#include "common/transport/memory_bus.hpp"
#include "services/mapper/mapper_service.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::services {

namespace channels = messages::channels;

inline synthetic::SyntheticSequence small_sequence() {
  synthetic::SequenceOptions options;
  options.session = 7;
  options.camera.width = 160;  // quick
  options.camera.height = 120;
  options.camera.fx /= 4.0;
  options.camera.fy /= 4.0;
  options.camera.cx = 79.5;
  options.camera.cy = 59.5;
  options.noise = synthetic::NoiseOptions{};
  options.noise->depth.steps_per_pixel = 32.0;  // as fine as with four times the focal length
  return synthetic::SyntheticSequence::make(options).value();
}

inline MapperOptions coarse() {
  MapperOptions options;
  options.tsdf.voxel_size = 0.05;
  return options;
}

inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// A mapper and the rest of the system, which is the test.
class Harness {
 public:
  /// `out`: empty for a folder of its own. `archive`: of an earlier session, to go on in; empty: none.
  Harness(bool lockstep, const MapperOptions& options, const std::filesystem::path& out = {},
          const std::filesystem::path& archive = {})
      : out_(out.empty() ? folder_.path() : out),
        context_(bus_of_service_, {"mapper", {}, {}, {}, out_, lockstep}),
        service_(context_, options) {
    const auto opened = service_.open(archive);
    EXPECT_TRUE(opened) << opened.error().message;
    listen<messages::Acknowledge>(channels::kAcknowledge, acknowledged);
    listen<mapping::MeshChunk>(channels::kMeshChunk, chunks);
    listen<messages::ResendRequest>(channels::kResend, requests);
  }

  /// `sequence`: below 0 the same as `index`.
  void send_frame(int index, int sequence = -1) {
    image::RgbdFrame frame = sequence_.frame(index);
    frame.header.sequence = sequence < 0 ? index : sequence;
    frame.header.session = session_of_frames;
    publish(channels::kRgbd, frame);
    if (features_come) publish(channels::kFeatures, planes_of(frame));
  }

  /// The planes of frame `index`; on FEATURES as the extractor, on KEYFRAME_FEATURES as the tracker sends them.
  void send_features(int index, const char* channel) {
    image::RgbdFrame frame = sequence_.frame(index);
    frame.header.session = session_of_frames;
    publish(channel, planes_of(frame));
  }

  /// As the tracker answers frame `index`, which is keyframe `keyframe` and has come as number `sequence`.
  void send_pose(int index, int keyframe, int sequence) {
    send_pose(index, keyframe, tracking::TrackingState::tracking, 7, sequence);
  }

  /// As the tracker answers frame `index`; `keyframe` below 0: it is none.
  void send_pose(int index, int keyframe, tracking::TrackingState state = tracking::TrackingState::tracking,
                 std::int64_t session = 7, int sequence = -1) {
    tracking::PoseEstimate pose;
    pose.header = {session, sequence < 0 ? index : sequence, 1000 + index};
    pose.state = state;
    pose.has_pose = true;
    pose.world_from_camera = sequence_.world_from_camera(index);
    pose.keyframe.value = keyframe;
    publish(channels::kPose, pose);
  }

  void send_end(std::int64_t frame_count) {
    publish(channels::kEndOfStream, messages::EndOfStream{session_of_frames, frame_count, {}});
  }

  void send_correction(std::int64_t version, int keyframe, const geometry::Pose& world_from_camera) {
    publish(channels::kPoseCorrection, tracking::PoseCorrection{7, version, {{{keyframe}, world_from_camera}}});
  }

  void idle(std::int64_t now_utime) {
    service_.idle(now_utime);
    deliver();
  }

  base::Status save() { return service_.save(); }

  std::string saved_mesh() {
    const auto saved = save();
    EXPECT_TRUE(saved) << saved.error().message;
    return read_file(out_ / "mesh.ply");
  }

  [[nodiscard]] std::size_t saved_vertices() {
    saved_mesh();
    return io::read_ply(out_ / "mesh.ply").value().vertices.size();
  }

  [[nodiscard]] geometry::Pose true_pose(int index) const { return sequence_.world_from_camera(index); }
  [[nodiscard]] messages::ServiceStatus status() { return context_.status().status(0); }
  [[nodiscard]] std::filesystem::path out() const { return out_; }

  std::int64_t session_of_frames = 7;
  bool features_come = true;  ///< with every frame
  std::vector<messages::Acknowledge> acknowledged;
  std::vector<mapping::MeshChunk> chunks;
  std::vector<messages::ResendRequest> requests;

 private:
  [[nodiscard]] static features::FrameFeatures planes_of(const image::RgbdFrame& frame) {
    const image::RectifiedFrame rectified = image::Rectifier().rectify(frame);
    auto planes = features::extract_planes(rectified.depth, rectified.camera).planes;
    return {frame.header, rectified.camera, {}, {}, std::move(planes), {}};
  }

  template <typename T>
  void listen(const char* channel, std::vector<T>& into) {
    const auto handler = [&into](const transport::ReceivedMessage& message) {
      EXPECT_LE(message.bytes.size(), 180'000U);
      auto value = messages::decode<T>(message.bytes);
      ASSERT_TRUE(value) << value.error().message;
      into.push_back(*value);
    };
    EXPECT_TRUE(bus_of_test_.subscribe(channel, handler, 0));
  }

  template <typename T>
  void publish(const char* channel, const T& value) {
    EXPECT_TRUE(bus_of_test_.publish(channel, messages::encode(value)));
    deliver();
  }

  void deliver() {
    EXPECT_TRUE(bus_of_service_.handle(std::chrono::milliseconds(0)));
    EXPECT_TRUE(bus_of_test_.handle(std::chrono::milliseconds(0)));
  }

  test::TemporaryFolder folder_;
  std::filesystem::path out_;
  synthetic::SyntheticSequence sequence_ = small_sequence();
  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_of_test_{network_};
  transport::MemoryBus bus_of_service_{network_};
  service::ServiceContext context_;
  MapperService service_;
};

}  // namespace eg::services
