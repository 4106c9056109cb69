#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "common/geometry/so3.hpp"
#include "common/io/graph_json.hpp"
#include "common/messages/channels.hpp"
#include "services/egraph_server/egraph_server_service.hpp"
#include "services/frame_source/frame_source_service.hpp"
#include "services/mapper/mapper_service.hpp"
#include "services/tracker/tracker_service.hpp"
#include "tests/support/bus_peer.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

/// Frame source, tracker, E-Graph server and mapper on a network that loses, repeats and reorders messages.
namespace eg {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kPeriod = 30'000;  // microseconds between frames, and of the test's clock

geometry::CameraModel camera() { return geometry::find_camera("tum_fr3").value(); }

/// A walk along one wall and back.
test::FeatureSequence record(int frames) {
  std::vector<geometry::Pose> poses;
  for (int i = 0; i < frames; ++i) {
    const double a = 2.0 * M_PI * i / 120.0;
    poses.push_back(test::looking_at({0.6 * std::sin(a), 0.1 * std::sin(2 * a), 0.0},
                                     {1.5 * std::sin(a), 0.3 * std::cos(a), 2.5}, camera()));
  }
  test::RoomOptions room;
  room.orientation = geometry::so3_exp({0.0, 0.3, 0.0});
  return test::record(test::make_room(room), camera(), poses, 1);
}

/// Small images of a wall, one for each frame of features.
class WallInput : public services::FrameInput {
 public:
  explicit WallInput(std::int64_t frames) : frames_(frames) {}
  [[nodiscard]] std::int64_t size() const override { return frames_; }
  [[nodiscard]] std::int64_t utime(std::int64_t index) const override { return kPeriod * index; }
  [[nodiscard]] base::Result<services::SourceFrame> read(std::int64_t index) const override {
    const geometry::CameraModel tiny{"tiny", 40, 30, 40, 40, 19.5, 14.5, {}, 1000, 30};
    return messages::compress({{0, 0, utime(index)},
                               tiny,
                               cv::Mat(30, 40, CV_8UC3, cv::Scalar::all(100)),
                               cv::Mat(30, 40, CV_16UC1, cv::Scalar::all(1000))});
  }
  [[nodiscard]] std::string description() const override { return "wall"; }

 private:
  std::int64_t frames_;
};

/// One process.
struct Node {
  Node(const std::shared_ptr<transport::MemoryNetwork>& network, const std::string& name, bool lockstep,
       const std::filesystem::path& out)
      : bus(network), context(bus, {name, {}, {}, {}, out, lockstep}) {}

  void step(std::int64_t now_utime) {
    ASSERT_TRUE(bus.handle(std::chrono::milliseconds(0)));
    if (service) service->idle(now_utime);
  }

  transport::MemoryBus bus;
  service::ServiceContext context;
  std::unique_ptr<service::Service> service;
};

class System {
 public:
  System(const transport::MemoryNetwork::Disturbance& disturbance, bool lockstep, int frames)
      : network_(std::make_shared<transport::MemoryNetwork>(disturbance)),
        sequence_(record(frames)),
        source_(network_, "frame_source", lockstep, folder_.path()),
        extractor_(network_, "feature_extractor", lockstep, folder_.path()),
        tracker_(network_, "tracker", lockstep, folder_.path()),
        server_(network_, "egraph_server", lockstep, folder_.path()),
        mapper_(network_, "mapper", lockstep, folder_.path()) {
    server_.service = std::make_unique<services::EGraphServerService>(server_.context, egraph::GraphBuilderOptions{});
    tracker_.service = std::make_unique<services::TrackerService>(tracker_.context, tracking::TrackerOptions{});
    services::MapperOptions mapper;
    mapper.tsdf.voxel_size = 0.05;
    mapper.mesh_period = 0.0;
    mapper_.service = std::make_unique<services::MapperService>(mapper_.context, mapper);
    extractor_.context.subscribe<image::RgbdFrame>(channels::kRgbd, 0, [this](const auto& frame) { extract(frame); });
    services::FrameSourceOptions options;
    source_.service =
        std::make_unique<services::FrameSourceService>(source_.context, options, std::make_unique<WallInput>(frames));
    for (const char* name : {"tracker", "mapper"}) announce(name);
  }

  /// Lets time pass.
  void run(double seconds) {
    for (const std::int64_t end = now_ + static_cast<std::int64_t>(1e6 * seconds); now_ < end; now_ += kPeriod) {
      for (Node* node : {&source_, &extractor_, &tracker_, &server_, &mapper_}) node->step(now_);
    }
  }

  std::string saved(const char* name) {
    for (Node* node : {&tracker_, &server_, &mapper_}) EXPECT_TRUE(node->service->save());
    return test::file_bytes(folder_.path() / name);
  }
  /// Without the comment at its head.
  std::int64_t saved_lines(const char* name) {
    const std::string text = saved(name);
    return std::count(text.begin(), text.end(), '\n') - 1;
  }
  std::size_t keyframes_in_graph() {
    saved("egraph.json");
    return io::read_graph(folder_.path() / "egraph.json").value().keyframes.size();
  }
  messages::ServiceStatus mapper_status() { return mapper_.context.status().status(0); }
  messages::ServiceStatus tracker_status() { return tracker_.context.status().status(0); }

 private:
  void announce(const std::string& name) {
    // In real time the source waits until it has heard of its consumers; a lost status would delay the test by 10 s.
    messages::ServiceStatus status;
    status.service = name;
    for (int i = 0; i < 20; ++i) extractor_.context.publish(channels::kStatus, status);
  }
  void extract(const image::RgbdFrame& frame) {
    features::FrameFeatures features = sequence_.frames[static_cast<std::size_t>(frame.header.sequence)];
    features.header = frame.header;
    extractor_.context.publish(channels::kFeatures, features);
  }

  test::TemporaryFolder folder_;
  std::shared_ptr<transport::MemoryNetwork> network_;
  test::FeatureSequence sequence_;
  Node source_, extractor_, tracker_, server_, mapper_;
  std::int64_t now_ = 1'000'000'000;
};

transport::MemoryNetwork::Disturbance disturbance(double loss) {
  transport::MemoryNetwork::Disturbance disturbance;
  disturbance.loss = loss;
  disturbance.duplication = loss;
  disturbance.reordering = loss;
  disturbance.seed = 7;
  return disturbance;
}

class Healing : public testing::TestWithParam<double> {};

TEST_P(Healing, InLockstepALossyNetworkGivesTheSameResults) {
  constexpr int kFrames = 120;
  System perfect({}, true, kFrames);
  perfect.run(10.0);
  System lossy(disturbance(GetParam()), true, kFrames);
  lossy.run(400.0);
  EXPECT_EQ(perfect.saved_lines("trajectory.txt"), kFrames);
  for (const char* name : {"trajectory.txt", "keyframes.txt", "egraph.json", "mesh.ply"}) {
    EXPECT_TRUE(perfect.saved(name) == lossy.saved(name)) << name;
  }
  EXPECT_EQ(lossy.mapper_status().frames, perfect.mapper_status().frames) << "a keyframe was fused twice or never";
}

TEST_P(Healing, InRealTimeEveryKeyframeEndsInGraphAndMapExactlyOnce) {
  constexpr int kFrames = 120;
  System system(disturbance(GetParam()), false, kFrames);
  system.run(1e-6 * kPeriod * kFrames + 12.0);
  const std::int64_t keyframes = system.saved_lines("keyframes.txt");
  EXPECT_GE(keyframes, 4);
  EXPECT_EQ(static_cast<std::int64_t>(system.keyframes_in_graph()), keyframes);
  EXPECT_EQ(system.mapper_status().frames, keyframes);
  EXPECT_EQ(system.mapper_status().dropped, 0);
  // Tracking goes on: every frame whose features arrived has a pose.
  const std::int64_t tracked = system.saved_lines("trajectory.txt");
  EXPECT_EQ(tracked, system.tracker_status().frames);
  EXPECT_GE(static_cast<double>(tracked), (1.0 - 3.0 * GetParam()) * kFrames - 2.0);
}

INSTANTIATE_TEST_SUITE_P(Loss, Healing, testing::Values(0.0, 0.01, 0.05, 0.2));

}  // namespace
}  // namespace eg
