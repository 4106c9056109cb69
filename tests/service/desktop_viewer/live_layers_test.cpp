#include "services/desktop_viewer/live_layers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/messages/channels.hpp"
#include "tests/support/bus_peer.hpp"

namespace eg::services {
namespace {

namespace channels = messages::channels;
using Vector3f = Eigen::Vector3f;

constexpr std::int64_t kSecond = 1'000'000;

/// A desktop viewer without its window, and the rest of the system.
class LiveLayersTest : public testing::Test {
 protected:
  void send_pose(std::int64_t sequence, const Eigen::Vector3d& position, int keyframe = -1, std::int64_t session = 1) {
    tracking::PoseEstimate pose;
    pose.header = {session, sequence, sequence * kSecond};
    pose.state = tracking::TrackingState::tracking;
    pose.has_pose = true;
    pose.world_from_camera.translation = position;
    pose.keyframe = {keyframe};
    rest_.send(channels::kPose, pose);
  }

  /// One triangle per part.
  void send_tile(int x, int revision, int parts = 1, std::int64_t session = 1) {
    for (int part = 0; part < parts; ++part) {
      mapping::MeshChunk chunk;
      chunk.session = session;
      chunk.tile = {x, 0, 0};
      chunk.tile_size = 0.64;
      chunk.revision = revision;
      chunk.part = part;
      chunk.parts = parts;
      chunk.mesh.vertices = {{0, 1, 0}, {1, 1, 0}, {0, 1, 1}};
      chunk.mesh.normals.assign(3, -Vector3f::UnitY());
      chunk.mesh.colours.assign(3, {1, 2, 3});
      chunk.mesh.triangles = {{0, 1, 2}};
      rest_.send(channels::kMeshChunk, chunk);
    }
  }

  /// What has changed since the last call, by name and part.
  std::map<std::string, io::PlyData> changes() {
    while (bus_.handle(std::chrono::milliseconds(0)).value_or(0) > 0) {
    }
    std::map<std::string, io::PlyData> result;
    for (const Layer& layer : layers_.take_changes()) result.emplace(layer.name + layer.part, layer.shape);
    return result;
  }

  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_{network_};
  service::ServiceContext context_{bus_, {"desktop_viewer", {}, {}, {}, {}, false}};
  test::BusPeer rest_{network_};
  LiveLayers layers_{context_, false};
};

TEST_F(LiveLayersTest, GrowAndFollowCorrections) {
  send_pose(0, {0, 0, 0}, 0);
  send_pose(1, {0, 0, 1});
  auto shapes = changes();
  ASSERT_EQ(shapes.at("trajectory").vertices.size(), 2u);
  EXPECT_EQ(shapes.at("trajectory").vertices[1], Vector3f(0, 1, 0)) << "ahead is the display's y";
  EXPECT_EQ(shapes.at("keyframes").edges.size(), 8u);
  EXPECT_TRUE(changes().empty());

  tracking::PoseCorrection correction;
  correction.session = correction.version = 1;
  correction.entries.resize(1);
  correction.entries[0].keyframe = {0};
  correction.entries[0].world_from_camera.translation = {0, -2, 0};
  rest_.send(channels::kPoseCorrection, correction);
  shapes = changes();
  EXPECT_EQ(shapes.at("trajectory").vertices[0], Vector3f(0, 0, 2)) << "up is the display's z";
  EXPECT_EQ(shapes.at("trajectory").vertices[1], Vector3f(0, 1, 2)) << "a frame goes with its keyframe";
}

TEST_F(LiveLayersTest, ShowTilesOnceAllPartsOfANewerRevisionAreThere) {
  send_pose(0, {0, 0, 0}, 0);
  send_tile(0, 3, 2);
  send_tile(1, 0);
  auto shapes = changes();
  EXPECT_EQ(shapes.at("mesh0 0 0").triangles.size(), 2u);
  EXPECT_EQ(shapes.at("mesh0 0 0").vertices[0], Vector3f(0, 0, -1));
  EXPECT_EQ(shapes.at("mesh1 0 0").triangles.size(), 1u);
  send_tile(0, 2);
  EXPECT_TRUE(changes().empty()) << "an older revision";

  messages::ServiceStatus status;
  status.service = "mapper";
  status.pid = 7;
  rest_.send(channels::kStatus, status);
  changes();
  send_tile(0, 0);
  EXPECT_EQ(changes().at("mesh0 0 0").triangles.size(), 1u) << "a mapper that was started again";
}

TEST_F(LiveLayersTest, KnowSeveralMappersApart) {
  const auto report = [this](const char* name, std::int32_t pid) {
    messages::ServiceStatus status;
    status.service = name;
    status.pid = pid;
    rest_.send(channels::kStatus, status);
    changes();
  };
  send_pose(0, {0, 0, 0}, 0);
  report("mapper.0", 7);
  report("mapper.1", 8);
  send_tile(0, 3);
  changes();
  report("mapper.0", 7);
  report("mapper.1", 8);
  report("mappers", 9);
  send_tile(0, 2);
  EXPECT_TRUE(changes().empty()) << "none of them was started again";
  report("mapper.1", 10);
  send_tile(0, 0);
  EXPECT_EQ(changes().at("mesh0 0 0").triangles.size(), 1u);
}

TEST_F(LiveLayersTest, AskForTheMeshUntilSomeOfItComes) {
  const auto requests = rest_.collect<messages::MeshRequest>(channels::kMeshRequest);
  layers_.idle(kSecond);
  EXPECT_EQ(rest_.handle(), 0) << "nobody is there yet";
  send_pose(0, {0, 0, 0}, 0, 5);
  changes();
  for (int second = 1; second <= 5; ++second) layers_.idle(second * kSecond);
  rest_.handle();
  ASSERT_EQ(requests->size(), 2u);
  EXPECT_EQ(requests->front().session, 5);
  send_tile(0, 0, 1, 5);
  changes();
  layers_.idle(60 * kSecond);
  rest_.handle();
  EXPECT_EQ(requests->size(), 2u);
}

TEST_F(LiveLayersTest, BeginAnewWithAnotherRun) {
  send_pose(100, {0, 0, 0}, 0);
  send_tile(0, 0);
  changes();
  send_pose(0, {1, 0, 0}, 0);
  auto shapes = changes();
  EXPECT_TRUE(shapes.at("mesh0 0 0").vertices.empty());
  EXPECT_EQ(shapes.at("trajectory").vertices.size(), 1u);
  send_pose(1, {1, 0, 0}, 0, 2);
  EXPECT_TRUE(changes().empty()) << "another robot, while this one is still heard";
  layers_.idle(10 * kSecond);
  send_pose(2, {1, 0, 0}, 0, 2);
  send_tile(0, 0, 1, 1);
  shapes = changes();
  EXPECT_EQ(shapes.at("trajectory").vertices.size(), 1u);
  EXPECT_FALSE(shapes.contains("mesh0 0 0")) << "of the session before";
}

}  // namespace
}  // namespace eg::services
