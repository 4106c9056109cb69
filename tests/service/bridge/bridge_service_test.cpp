#include "services/bridge/bridge_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bot_core/pointcloud2_t.hpp>
#include <bot_core/pose_t.hpp>
#include <cstring>
#include <vs/link_collection_t.hpp>
#include <vs/object_collection_t.hpp>

#include "common/messages/channels.hpp"
#include "tests/support/bus_peer.hpp"

namespace eg::services {
namespace {

namespace channels = messages::channels;

TEST(BotTypes, HaveTheFingerprintsOfLibbot2) {
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::pose_t::getHash()), 0x2e16efb052b0105eU);
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::pointcloud2_t::getHash()), 0x0bcd5ce4bf5a1b4aU);
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::pointfield_t::getHash()), 0xb24e10825e0b476dU);
  EXPECT_EQ(static_cast<std::uint64_t>(vs::object_collection_t::getHash()), 0x48dae1018f96f277U);
  EXPECT_EQ(static_cast<std::uint64_t>(vs::link_collection_t::getHash()), 0xd8955824928300eaU);
}

class Bridge : public testing::Test {
 protected:
  template <typename Wire>
  void listen(const char* channel, std::vector<Wire>& into) {
    ASSERT_TRUE(viewer_.subscribe(
        channel,
        [&into](const transport::ReceivedMessage& message) {
          const int size = static_cast<int>(message.bytes.size());
          ASSERT_EQ(into.emplace_back().decode(message.bytes.data(), 0, size), size);
        },
        0));
  }
  void SetUp() override {
    listen("POSE_BODY", poses_);
    listen("OBJECT_COLLECTION", objects_);
    listen("LINK_COLLECTION", links_);
    listen("MAP_CLOUD", clouds_);
  }
  template <typename T>
  void send(const char* channel, const T& value) {
    system_.send(channel, value);
    ASSERT_TRUE(bus_.handle(std::chrono::milliseconds(0)));
    ASSERT_TRUE(viewer_.handle(std::chrono::milliseconds(0)));
  }
  void send_keyframe(std::int32_t id, const Eigen::Vector3d& position) {
    egraph::Keyframe keyframe;
    keyframe.header = {3, id, 1000 + id};
    keyframe.id.value = id;
    keyframe.world_from_camera.translation = position;
    send(channels::kKeyframe, keyframe);
  }

  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_{network_};
  transport::MemoryBus viewer_{network_};
  test::BusPeer system_{network_};
  service::ServiceContext context_{bus_, {}};
  BridgeService bridge_{context_};
  std::vector<bot_core::pose_t> poses_;
  std::vector<vs::object_collection_t> objects_;
  std::vector<vs::link_collection_t> links_;
  std::vector<bot_core::pointcloud2_t> clouds_;
};

TEST_F(Bridge, TurnsTheCamerasAxesIntoTheBodys) {
  tracking::PoseEstimate pose;
  pose.header.utime = 77;
  pose.world_from_camera.translation = {1.0, 2.0, 3.0};  // right, down, forward
  pose.world_from_camera.rotation =
      Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()).toRotationMatrix();  // to the right
  send(channels::kPose, pose);
  EXPECT_TRUE(poses_.empty()) << "a frame without a pose";
  pose.has_pose = true;
  send(channels::kPose, pose);
  ASSERT_EQ(poses_.size(), 1U);
  EXPECT_EQ(poses_[0].utime, 77);
  EXPECT_THAT(poses_[0].pos, testing::ElementsAre(3.0, -1.0, -2.0));
  EXPECT_NEAR(poses_[0].orientation[0], std::cos(0.1), 1e-12);
  EXPECT_NEAR(poses_[0].orientation[3], -std::sin(0.1), 1e-12) << "to the right is against z up";
}

TEST_F(Bridge, SendsKeyframesOnceMovesThemAndSendsAllAgain) {
  send_keyframe(0, {0, 0, 0});
  send_keyframe(1, {0, 0, 1});
  send_keyframe(1, {0, 0, 1});
  ASSERT_EQ(objects_.size(), 2U);
  EXPECT_EQ(objects_[1].type, 4);
  EXPECT_EQ(objects_[1].objects[0].id, 1);
  EXPECT_EQ(objects_[1].objects[0].x, 1.0);
  tracking::PoseCorrection correction{3, 5, {{{1}, {Eigen::Matrix3d::Identity(), {0, 0, 2}}}}};
  send(channels::kPoseCorrection, correction);
  correction.version = 4;
  correction.entries[0].world_from_camera.translation.z() = 9.0;
  send(channels::kPoseCorrection, correction);
  objects_.clear();
  bridge_.idle(10'000'000);
  ASSERT_TRUE(viewer_.handle(std::chrono::milliseconds(0)));
  ASSERT_EQ(objects_.size(), 1U);
  ASSERT_EQ(objects_[0].nobjects, 2);
  EXPECT_EQ(objects_[0].objects[1].x, 2.0) << "an older correction changes nothing";
}

TEST_F(Bridge, SendsEdgesAsLinksBetweenKeyframes) {
  // Two keyframes that saw the same two walls.
  for (std::int32_t id = 0; id < 2; ++id) {
    egraph::GraphUpdate update;
    update.session = 3;
    update.base_version = id;
    update.version = id + 1;
    update.keyframe.id.value = id;
    for (std::int32_t wall = 0; wall < 2; ++wall) {
      egraph::DirectionLandmark landmark;
      landmark.id.value = wall;
      landmark.direction = Eigen::Vector3d::Unit(wall);
      update.landmarks.push_back(landmark);
      egraph::Observation observation;
      observation.keyframe = update.keyframe.id;
      observation.landmark = landmark.id;
      update.observations.push_back(observation);
    }
    send(channels::kGraphUpdate, update);
    send(channels::kGraphUpdate, update);
  }
  send_keyframe(0, {0, 0, 0});
  ASSERT_EQ(links_.size(), 1U);
  EXPECT_EQ(links_[0].links[0].id1, 0);
  EXPECT_EQ(links_[0].links[0].id2, 1);
  EXPECT_EQ(links_[0].links[0].collection1, objects_.at(0).id);
}

mapping::MeshChunk chunk(int tile, int revision, int vertices) {
  mapping::MeshChunk chunk;
  chunk.session = 3;
  chunk.tile = {tile, 0, 0};
  chunk.tile_size = 1.0;
  chunk.revision = revision;
  for (int i = 0; i < vertices; ++i) {
    chunk.mesh.vertices.emplace_back(1.0F, 2.0F, 3.0F);  // right, down, forward
    chunk.mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
    chunk.mesh.colours.push_back({10, 20, 30});
  }
  return chunk;
}

TEST_F(Bridge, SendsTheMeshAsAThinnedCloud) {
  send(channels::kMeshChunk, chunk(0, 2, 5));
  send(channels::kMeshChunk, chunk(0, 1, 9));  // older
  bridge_.idle(10'000'000);
  ASSERT_TRUE(viewer_.handle(std::chrono::milliseconds(0)));
  ASSERT_EQ(clouds_.size(), 1U);
  EXPECT_EQ(clouds_[0].width, 5);
  EXPECT_EQ(clouds_[0].point_step, 16);
  EXPECT_EQ(clouds_[0].fields[3].name, "rgb");
  std::array<float, 3> position{};
  std::memcpy(position.data(), clouds_[0].data.data(), sizeof position);
  EXPECT_THAT(position, testing::ElementsAre(3.0F, -1.0F, -2.0F)) << "x forward, y left, z up";
  EXPECT_THAT(std::vector<int>(clouds_[0].data.begin() + 12, clouds_[0].data.begin() + 15),
              testing::ElementsAre(30, 20, 10));

  for (int tile = 1; tile < 60; ++tile) send(channels::kMeshChunk, chunk(tile, 1, 1000));
  bridge_.idle(20'000'000);
  ASSERT_TRUE(viewer_.handle(std::chrono::milliseconds(0)));
  ASSERT_EQ(clouds_.size(), 2U);
  EXPECT_LE(clouds_[1].width, 10'000);
  EXPECT_GE(clouds_[1].width, 4'000);
}

TEST_F(Bridge, AsksForCorrectionsThatItMissed) {
  const auto requests = system_.collect<messages::ResendRequest>(channels::kResend);
  send(channels::kPoseCorrection, tracking::PoseCorrection{3, 5, {{{1}, {}}}, 4});
  bridge_.idle(1'000'000);
  bridge_.idle(2'000'000);
  system_.handle();
  ASSERT_FALSE(requests->empty());
  EXPECT_EQ(requests->front().session, 3);
  EXPECT_EQ(requests->front().channel, channels::kPoseCorrection);
  EXPECT_THAT(requests->front().numbers, testing::ElementsAre(0));
}

}  // namespace
}  // namespace eg::services
