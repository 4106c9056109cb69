#include "services/mapper/mapper_service.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/io/ply.hpp"
#include "common/messages/channels.hpp"
#include "common/synthetic/sequence.hpp"
#include "common/transport/memory_bus.hpp"
#include "services/mapper/mapper_config.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::services {
namespace {

namespace channels = messages::channels;

synthetic::SyntheticSequence small_sequence() {
  synthetic::SequenceOptions options;
  options.session = 7;
  options.camera.width = 160;  // quick
  options.camera.height = 120;
  options.camera.fx /= 4.0;
  options.camera.fy /= 4.0;
  options.camera.cx = 79.5;
  options.camera.cy = 59.5;
  return synthetic::SyntheticSequence::make(options).value();
}

MapperOptions coarse() {
  MapperOptions options;
  options.tsdf.voxel_size = 0.05;
  return options;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// A mapper and the rest of the system, which is the test.
class Harness {
 public:
  Harness(bool lockstep, const MapperOptions& options)
      : context_(bus_of_service_, {"mapper", {}, {}, {}, folder_.path(), lockstep}), service_(context_, options) {
    listen<messages::Acknowledge>(channels::kAcknowledge, acknowledged);
    listen<mapping::MeshChunk>(channels::kMeshChunk, chunks);
  }

  void send_frame(int index) {
    image::RgbdFrame frame = sequence_.frame(index);
    frame.header.sequence = index;
    publish(channels::kRgbd, frame);
  }

  /// As the tracker answers frame `index`; `keyframe` below 0: it is none.
  void send_pose(int index, int keyframe, tracking::TrackingState state = tracking::TrackingState::tracking,
                 std::int64_t session = 7) {
    tracking::PoseEstimate pose;
    pose.header = {session, index, 1000 + index};
    pose.state = state;
    pose.has_pose = true;
    pose.world_from_camera = sequence_.world_from_camera(index);
    pose.keyframe.value = keyframe;
    publish(channels::kPose, pose);
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
    return read_file(folder_.path() / "mesh.ply");
  }

  [[nodiscard]] std::size_t saved_vertices() {
    saved_mesh();
    return io::read_ply(folder_.path() / "mesh.ply").value().vertices.size();
  }

  [[nodiscard]] geometry::Pose true_pose(int index) const { return sequence_.world_from_camera(index); }
  [[nodiscard]] messages::ServiceStatus status() { return context_.status().status(0); }
  [[nodiscard]] std::filesystem::path out() const { return folder_.path(); }

  std::vector<messages::Acknowledge> acknowledged;
  std::vector<mapping::MeshChunk> chunks;

 private:
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
  synthetic::SyntheticSequence sequence_ = small_sequence();
  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_of_test_{network_};
  transport::MemoryBus bus_of_service_{network_};
  service::ServiceContext context_;
  MapperService service_;
};

TEST(MapperServiceTest, FusesKeyframesAndAcknowledgesEveryFrame) {
  Harness mapper(true, coarse());
  for (int i = 0; i < 4; ++i) {
    mapper.send_frame(i);
    EXPECT_EQ(mapper.acknowledged.size(), static_cast<std::size_t>(i)) << "before its pose is known";
    mapper.send_pose(i, i == 0 ? 0 : i == 3 ? 1 : -1);
    ASSERT_EQ(mapper.acknowledged.size(), static_cast<std::size_t>(i + 1));
    EXPECT_EQ(mapper.acknowledged.back().sequence, i);
    EXPECT_EQ(mapper.acknowledged.back().session, 7);
    EXPECT_EQ(mapper.acknowledged.back().consumer, "mapper");
  }
  EXPECT_EQ(mapper.status().frames, 2);
  EXPECT_GT(mapper.saved_vertices(), 500U);
  EXPECT_GT(std::filesystem::file_size(mapper.out() / "mesh.vdb"), 10'000U);
}

TEST(MapperServiceTest, WorksOffWhatComesOutOfOrder) {
  Harness in_order(true, coarse());
  for (int i = 0; i < 3; ++i) {
    in_order.send_frame(i);
    in_order.send_pose(i, i);
  }
  Harness mapper(true, coarse());
  mapper.send_pose(1, 1);
  mapper.send_frame(2);
  mapper.send_frame(1);
  mapper.send_pose(2, 2);
  mapper.send_pose(0, 0);
  EXPECT_TRUE(mapper.acknowledged.empty());
  mapper.send_frame(0);
  ASSERT_FALSE(mapper.acknowledged.empty());
  EXPECT_EQ(mapper.acknowledged.back().sequence, 2);
  EXPECT_EQ(mapper.saved_mesh(), in_order.saved_mesh());
}

TEST(MapperServiceTest, AcknowledgesAFinishedFrameAgainWithoutFusingItAgain) {
  Harness mapper(true, coarse());
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  const std::string once = mapper.saved_mesh();
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  EXPECT_EQ(mapper.acknowledged.size(), 2U);
  EXPECT_EQ(mapper.acknowledged.back().sequence, 0);
  EXPECT_EQ(mapper.saved_mesh(), once);
  EXPECT_EQ(mapper.status().frames, 1);
}

TEST(MapperServiceTest, KeepsOutWhatWasNotTracked) {
  using State = tracking::TrackingState;
  Harness mapper(true, coarse());
  int index = 0;
  for (const State state : {State::initialising, State::rotation_only, State::lost}) {
    mapper.send_frame(index);
    mapper.send_pose(index, index, state);
    ++index;
  }
  EXPECT_EQ(mapper.acknowledged.size(), 3U);
  EXPECT_NE(mapper.saved_mesh().find("element vertex 0\n"), std::string::npos);
  EXPECT_EQ(mapper.status().frames, 0);
}

TEST(MapperServiceTest, RejectsAnotherSession) {
  Harness mapper(true, coarse());
  mapper.send_frame(0);
  mapper.send_pose(0, 0, tracking::TrackingState::tracking, 8);
  EXPECT_TRUE(mapper.acknowledged.empty());
  EXPECT_EQ(mapper.status().rejected, 1);
  EXPECT_NE(mapper.status().last_rejection.find("session"), std::string::npos);
}

TEST(MapperServiceTest, InRealTimeCountsAKeyframeWhoseImagesAreGone) {
  Harness mapper(false, coarse());
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  mapper.send_frame(1);  // 2 is lost
  mapper.send_pose(2, 1);
  mapper.send_frame(3);
  mapper.send_pose(3, 2);
  EXPECT_TRUE(mapper.acknowledged.empty());
  EXPECT_EQ(mapper.status().frames, 2);
  EXPECT_EQ(mapper.status().dropped, 1);
}

TEST(MapperServiceTest, ACorrectedMapIsTheMapOfTheCorrectedPoses) {
  Harness right(true, coarse());
  for (int i = 0; i < 3; ++i) {
    right.send_frame(i);
    right.send_pose(i, i);
  }
  // The same with one keyframe that was tracked wrongly at first.
  Harness mapper(true, coarse());
  geometry::Pose wrong = mapper.true_pose(1);
  wrong.translation += Eigen::Vector3d(0.3, -0.1, 0.2);
  for (int i = 0; i < 3; ++i) {
    mapper.send_frame(i);
    mapper.send_pose(i, i);
  }
  mapper.send_correction(1, 1, wrong);
  mapper.idle(0);
  EXPECT_NE(mapper.saved_mesh(), right.saved_mesh());
  mapper.send_correction(2, 1, mapper.true_pose(1));
  mapper.send_correction(1, 1, wrong);  // late
  mapper.idle(20'000);
  EXPECT_EQ(mapper.saved_mesh(), right.saved_mesh());
}

TEST(MapperServiceTest, ACorrectionMayComeBeforeItsKeyframeAndBeSmall) {
  Harness early(true, coarse());
  Harness late(true, coarse());
  geometry::Pose moved = early.true_pose(0);
  moved.translation.x() += 0.004;
  early.send_correction(1, 0, moved);
  for (Harness* mapper : {&early, &late}) {
    mapper->send_frame(0);
    mapper->send_pose(0, 0);
  }
  const std::string unmoved = late.saved_mesh();
  late.send_correction(1, 0, moved);
  EXPECT_NE(late.saved_mesh(), unmoved);
  EXPECT_EQ(late.saved_mesh(), early.saved_mesh());
}

TEST(MapperServiceTest, WithoutABudgetForImagesKeyframesStay) {
  MapperOptions options = coarse();
  options.image_budget = 0;
  Harness mapper(true, options);
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  const std::string before = mapper.saved_mesh();
  mapper.send_correction(1, 0, mapper.true_pose(60));
  mapper.idle(0);
  EXPECT_EQ(mapper.saved_mesh(), before);
}

TEST(MapperServiceTest, StreamsTheWholeMeshAndRepeatsIt) {
  Harness mapper(true, coarse());
  mapper.idle(1);
  EXPECT_TRUE(mapper.chunks.empty());
  mapper.send_frame(0);
  mapper.send_pose(0, 0);
  std::int64_t now = 2'000'000;
  for (int round = 0; round < 100; ++round) mapper.idle(now += 20'000);
  std::set<std::array<int, 3>> tiles;
  std::size_t triangles = 0;
  std::size_t first_pass = 0;
  for (const mapping::MeshChunk& chunk : mapper.chunks) {
    EXPECT_EQ(chunk.session, 7);
    EXPECT_EQ(chunk.revision, 0);
    EXPECT_DOUBLE_EQ(chunk.tile_size, 32 * 0.05);
    if (!tiles.insert({chunk.tile.x(), chunk.tile.y(), chunk.tile.z()}).second) break;
    triangles += chunk.mesh.triangles.size();
    ++first_pass;
  }
  mapper.saved_mesh();
  EXPECT_EQ(triangles, io::read_ply(mapper.out() / "mesh.ply").value().triangles.size());
  EXPECT_GT(mapper.chunks.size(), first_pass) << "for viewers that came late";

  mapper.chunks.clear();
  mapper.send_frame(1);
  mapper.send_pose(1, 1);
  for (int round = 0; round < 60; ++round) mapper.idle(now += 20'000);
  ASSERT_FALSE(mapper.chunks.empty());
  EXPECT_EQ(mapper.chunks[0].revision, 1);
}

TEST(MapperServiceTest, AnOutputFolderThatIsGoneIsAnError) {
  Harness mapper(true, coarse());
  std::filesystem::remove_all(mapper.out());
  const auto saved = mapper.save();
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().message.find("mesh.ply"), std::string::npos) << saved.error().message;
}

TEST(MapperConfigTest, SetsEveryOption) {
  MapperOptions options;
  io::ConfigSchema schema;
  describe_options(schema, options);
  ASSERT_TRUE(io::parse_config("voxel_size: 0.01\nmesh_period: 0\nimage_budget: 12\n", "test", schema));
  EXPECT_EQ(options.tsdf.voxel_size, 0.01);
  EXPECT_EQ(options.mesh_period, 0.0);
  EXPECT_EQ(options.image_budget, 12);
  EXPECT_FALSE(io::parse_config("voxel_sise: 0.01\n", "test", schema));
  EXPECT_FALSE(io::parse_config("voxel_size: 0\n", "test", schema));
}

}  // namespace
}  // namespace eg::services
