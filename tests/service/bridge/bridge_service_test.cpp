#include "services/bridge/bridge_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bot_core/pose_t.hpp>
#include <vs/link_collection_t.hpp>
#include <vs/object_collection_t.hpp>

#include "common/messages/channels.hpp"
#include "tests/support/bus_peer.hpp"

namespace eg::services {
namespace {

namespace channels = messages::channels;

TEST(BotTypes, HaveTheFingerprintsOfLibbot2) {
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::pose_t::getHash()), 0x2e16efb052b0105eU);
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
  egraph::GraphUpdate update;
  update.session = 3;
  update.version = 1;
  update.keyframe.id.value = 2;
  update.edges.emplace_back();
  update.edges.back().first.value = 0;
  update.edges.back().second.value = 2;
  send(channels::kGraphUpdate, update);
  send(channels::kGraphUpdate, update);
  send_keyframe(0, {0, 0, 0});
  ASSERT_EQ(links_.size(), 1U);
  EXPECT_EQ(links_[0].links[0].id1, 0);
  EXPECT_EQ(links_[0].links[0].id2, 2);
  EXPECT_EQ(links_[0].links[0].collection1, objects_.at(0).id);
}

}  // namespace
}  // namespace eg::services
