#include "services/viewer/viewer_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <numbers>

#include "common/egraph/graph_builder.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/service_state.hpp"
#include "tests/service/viewer/read_packet.hpp"
#include "tests/support/bus_peer.hpp"
#include "tests/support/web_client.hpp"

namespace eg::services {
namespace {

using namespace std::chrono_literals;
using testing::UnorderedElementsAre;
namespace channels = messages::channels;

constexpr std::int64_t kSecond = 1'000'000;

/// A viewer, the rest of the system, and a browser.
class ViewerServiceTest : public testing::Test {
 protected:
  ViewerServiceTest() : context_(bus_, {"viewer", {}, {}, {}, {}, false}) {
    ViewerOptions options;
    options.web.address = "127.0.0.1:0";
    options.page = std::filesystem::path(EGRAPH_SOURCE_DIR) / "services/viewer/page";
    auto service = ViewerService::make(context_, options);
    EXPECT_TRUE(service) << service.error().message;
    service_ = std::move(*service);
  }

  std::uint16_t port() const {
    return static_cast<std::uint16_t>(std::stoi(service_->url().substr(service_->url().rfind(':') + 1)));
  }

  /// Lets the viewer hear what has been said, and some time pass.
  void pass(std::int64_t microseconds = 2 * kSecond) {
    while (bus_.handle(0ms).value_or(0) > 0) {
    }
    now_ += microseconds;
    service_->idle(now_);
    rest_.handle();
  }

  /// What a browser that comes now gets, by "type" or "type/number" of numbered packets. The last of each counts.
  std::map<std::string, test::ReadPacket> look() {
    const auto stream = test::WebSocketClient::connect(port(), "/stream");
    std::map<std::string, test::ReadPacket> packets;
    while (const auto bytes = stream->read(200ms)) {
      test::ReadPacket packet(*bytes);
      std::string key = packet.head["type"];
      if (key == "tile") {
        for (const int i : packet.array<int>("tile")) key.append("/").append(std::to_string(i));
      }
      if (key == "contents")
        packets.insert_or_assign(fmt::format("contents/{}", packet.head["keyframe"].get<int>()), packet);
      packets.insert_or_assign(key, packet);
    }
    return packets;
  }

  features::FrameFeatures features_of(const image::FrameHeader& header) const {
    features::FrameFeatures features;
    features.header = header;
    features.camera = camera_;
    features.points.resize(5);
    for (auto& point : features.points) {
      point.depth = 1.0;
      point.depth_sigma = 0.01;
    }
    features.lines.resize(2);
    for (auto& line : features.lines) line.end_pixel = {10.0, 0.0};
    features.lines[0].has_depth = true;
    features.lines[0].end = Eigen::Vector3d::UnitX();
    features.lines[0].direction = 1;
    features.directions = directions_;
    for (auto& direction : features.directions) direction.kind = features::DirectionKind::vanishing_direction;
    return features;
  }

  static image::FrameHeader header_of(int id, std::int64_t session = 1) { return {session, 10 * id, kSecond * id}; }

  /// One frame as the whole system deals with it; it becomes a keyframe.
  void send_keyframe(int id, const geometry::Pose& world_from_camera, std::int64_t session = 1) {
    const image::FrameHeader header = header_of(id, session);
    image::RgbdFrame frame{header, camera_, cv::Mat(24, 32, CV_8UC3, cv::Scalar(id, 0, 0)),
                           cv::Mat(24, 32, CV_16UC1, cv::Scalar(5000))};
    rest_.send(channels::kRgbd, frame);
    rest_.send(channels::kFeatures, features_of(header));
    tracking::PoseEstimate pose;
    pose.header = header;
    pose.state = tracking::TrackingState::tracking;
    pose.reason = "because of \"tests\"";
    pose.has_pose = true;
    pose.world_from_camera = world_from_camera;
    pose.keyframe = {id};
    rest_.send(channels::kPose, pose);

    egraph::Keyframe keyframe;
    keyframe.header = header;
    keyframe.id = {id};
    keyframe.world_from_camera = world_from_camera;
    keyframe.directions = directions_;
    keyframe.plane_distances.assign(directions_.size(), 1.0);
    if (id > 0) keyframe.covisible = {{{id - 1}, 50}};
    const auto update = builder_.add_keyframe(keyframe);
    ASSERT_TRUE(update) << update.error().message;
    last_update_ = *update;
  }

  void send_update() { rest_.send(channels::kGraphUpdate, last_update_); }

  static mapping::MeshChunk chunk(int x, int revision, int part = 0, int parts = 1) {
    mapping::MeshChunk chunk;
    chunk.session = 1;
    chunk.tile = {x, 0, 0};
    chunk.revision = revision;
    chunk.part = part;
    chunk.parts = parts;
    chunk.tile_size = 1.0;
    chunk.mesh.vertices = {{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 0.5F, 0.0F}};
    chunk.mesh.normals.assign(3, Eigen::Vector3f::UnitZ());
    chunk.mesh.colours.assign(3, {10, 20, 30});
    chunk.mesh.triangles = {{0, 1, 2}};
    return chunk;
  }

  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_{network_};
  test::BusPeer rest_{network_};
  service::ServiceContext context_;
  std::unique_ptr<ViewerService> service_;
  std::int64_t now_ = kSecond;
  geometry::CameraModel camera_ = [] {
    geometry::CameraModel camera = *geometry::find_camera("synthetic");
    camera.width = 32;
    camera.height = 24;
    return camera;
  }();
  std::vector<features::DirectionFeature> directions_ = [] {
    std::vector<features::DirectionFeature> directions(2);
    directions[0].direction = -Eigen::Vector3d::UnitZ();
    directions[1].direction = Eigen::Vector3d::UnitX();
    for (auto& direction : directions) {
      direction.kind = features::DirectionKind::plane_normal;
      direction.covariance =
          1e-4 * (Eigen::Matrix3d::Identity() - direction.direction * direction.direction.transpose());
    }
    return directions;
  }();
  egraph::GraphBuilder builder_{egraph::GraphBuilderOptions{}};
  egraph::GraphUpdate last_update_;
};

geometry::Pose at(double x) { return {Eigen::Matrix3d::Identity(), Eigen::Vector3d(x, 0.0, 0.0)}; }

TEST_F(ViewerServiceTest, ShowsWhatTheSystemSays) {
  for (int id = 0; id < 3; ++id) {
    send_keyframe(id, at(id));
    send_update();
    pass();
  }
  const auto seen = look();
  EXPECT_EQ(seen.at("poses").array<std::int32_t>("ids"), (std::vector<std::int32_t>{0, 1, 2}));
  EXPECT_EQ(seen.at("graph").array<std::int32_t>("edges"), (std::vector<std::int32_t>{0, 1, 0, 2, 1, 2}));
  EXPECT_EQ(seen.at("graph").array<std::int32_t>("covisibility"), (std::vector<std::int32_t>{0, 1, 1, 2}));
  EXPECT_EQ(seen.at("landmarks").array<std::int32_t>("ids").size(), 2u);
  EXPECT_EQ(seen.at("trajectory").array<std::int32_t>("keyframes"), (std::vector<std::int32_t>{0, 1, 2}));
  EXPECT_EQ(seen.at("contents").array<float>("points").size(), 15u);
  EXPECT_EQ(seen.at("contents").array<float>("lines").size(), 6u);
  EXPECT_EQ(seen.at("contents").array<std::int32_t>("line_colours"), std::vector<std::int32_t>{1});
  EXPECT_EQ(seen.at("camera").head["state"], "tracking");
  EXPECT_EQ(seen.at("camera").head["reason"], "because of \"tests\"");
  const auto image = test::http_get(port(), "/keyframe/1.jpg");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->content_type, "image/jpeg");
}

TEST_F(ViewerServiceTest, AsksForTheGraphWhenItMissedAnUpdate) {
  const auto requests = rest_.collect<messages::GraphRequest>(channels::kGraphRequest);
  send_keyframe(0, at(0.0));  // its update gets lost
  send_keyframe(1, at(1.0));
  send_update();
  pass();
  pass();
  ASSERT_GE(requests->size(), 1u);
  EXPECT_EQ(requests->front().session, 1);
  rest_.send(channels::kGraphSnapshot, builder_.graph().snapshot(1));
  pass();
  EXPECT_EQ(look().at("graph").array<std::int32_t>("edges"), (std::vector<std::int32_t>{0, 1}));
  const std::size_t asked = requests->size();
  pass(10 * kSecond);
  EXPECT_EQ(requests->size(), asked);
}

TEST_F(ViewerServiceTest, ALateViewerAsksForWhatKeyframesShowed) {
  const auto requests = rest_.collect<messages::ResendRequest>(channels::kResend);
  for (int id = 0; id < 6; ++id) {  // before the viewer was there
    egraph::Keyframe keyframe;
    keyframe.header = header_of(id);
    keyframe.id = {id};
    keyframe.world_from_camera = at(id);
    ASSERT_TRUE(builder_.add_keyframe(keyframe));
  }
  send_keyframe(6, at(6.0));
  rest_.send(channels::kGraphSnapshot, builder_.graph().snapshot(1));
  pass();
  pass();
  ASSERT_FALSE(requests->empty());
  EXPECT_EQ(requests->front().channel, channels::kKeyframeFeatures);
  EXPECT_EQ(requests->front().numbers, (std::vector<std::int64_t>{5, 4, 3, 2})) << "the newest first";
  EXPECT_EQ(look().at("trajectory").array<std::int32_t>("keyframes"), (std::vector<std::int32_t>{0, 1, 2, 3, 4, 5, 6}));

  for (int id = 0; id < 6; ++id) rest_.send(channels::kKeyframeFeatures, features_of(header_of(id)));
  pass();
  pass();
  const auto seen = look();
  for (int id = 0; id < 7; ++id) EXPECT_TRUE(seen.contains(fmt::format("contents/{}", id))) << id;
  const std::size_t asked = requests->size();
  pass(10 * kSecond);
  EXPECT_EQ(requests->size(), asked) << "nothing is missing any more";
}

TEST_F(ViewerServiceTest, StopsAskingForWhatNobodyHas) {
  const auto requests = rest_.collect<messages::ResendRequest>(channels::kResend);
  egraph::Keyframe keyframe;
  keyframe.id = {0};
  keyframe.header = header_of(0);
  ASSERT_TRUE(builder_.add_keyframe(keyframe));
  send_keyframe(1, at(1.0));
  rest_.send(channels::kGraphSnapshot, builder_.graph().snapshot(1));
  for (int i = 0; i < 20; ++i) pass();
  EXPECT_EQ(requests->size(), 5u);
}

TEST_F(ViewerServiceTest, CorrectionsMoveKeyframesAndWhatHangsOnThem) {
  send_keyframe(0, at(0.0));
  send_update();
  pass();
  rest_.send(channels::kPoseCorrection, tracking::PoseCorrection{1, 1, {{{0}, at(5.0)}}});
  send_keyframe(0, at(0.0));  // announced again: older than the correction
  pass();
  const auto seen = look();
  EXPECT_EQ(seen.at("poses").array<float>("poses")[9], 5.0F);
  EXPECT_EQ(seen.at("trajectory").array<float>("positions")[0], 0.0F);  // in its keyframe
}

TEST_F(ViewerServiceTest, PutsTilesTogetherAndIgnoresOldRevisions) {
  rest_.send(channels::kMeshChunk, chunk(0, 1, 0, 2));
  pass();
  EXPECT_FALSE(look().contains("tile/0/0/0"));
  rest_.send(channels::kMeshChunk, chunk(0, 1, 1, 2));
  rest_.send(channels::kMeshChunk, chunk(1, 0));
  pass();
  auto seen = look();
  EXPECT_EQ(seen.at("tile/0/0/0").array<std::uint16_t>("indices"), (std::vector<std::uint16_t>{0, 1, 2, 3, 4, 5}));
  const auto positions = seen.at("tile/1/0/0").array<std::uint16_t>("positions");
  EXPECT_EQ(positions[4], 65535);  // x = 1 m of 1 m
  EXPECT_EQ(positions[9], 32768);  // y = 0.5 m in the same scale

  mapping::MeshChunk empty = chunk(0, 2);
  empty.mesh = {};
  rest_.send(channels::kMeshChunk, empty);
  rest_.send(channels::kMeshChunk, chunk(1, 0));
  pass();
  seen = look();
  EXPECT_TRUE(seen.at("tile/0/0/0").array<std::uint16_t>("indices").empty());
}

TEST_F(ViewerServiceTest, AMapperThatStartsAgainIsListenedTo) {
  messages::ServiceStatus status;
  status.service = "mapper";
  status.pid = 10;
  rest_.send(channels::kStatus, status);
  rest_.send(channels::kMeshChunk, chunk(0, 7));
  pass();
  status.pid = 11;
  rest_.send(channels::kStatus, status);
  mapping::MeshChunk other = chunk(0, 0);
  other.mesh.triangles.push_back({2, 1, 0});
  rest_.send(channels::kMeshChunk, other);
  pass();
  EXPECT_EQ(look().at("tile/0/0/0").array<std::uint16_t>("indices").size(), 6u);
}

TEST_F(ViewerServiceTest, MappersThatShareTheSpaceAreKnownApart) {
  messages::ServiceStatus status;
  const auto report = [&](const char* name, std::int32_t pid) {
    status.service = name;
    status.pid = pid;
    rest_.send(channels::kStatus, status);
  };
  for (int round = 0; round < 2; ++round) {
    report("mapper.0", 10);
    report("mapper.1", 11);
    mapping::MeshChunk older = chunk(0, 7 - round);
    for (int i = 0; i < round; ++i) older.mesh.triangles.push_back({2, 1, 0});
    rest_.send(channels::kMeshChunk, older);
    pass();
  }
  auto seen = look();
  EXPECT_EQ(nlohmann::json::parse(seen.at("health").arrays.at("json")).size(), 2u);
  EXPECT_EQ(seen.at("tile/0/0/0").array<std::uint16_t>("indices").size(), 3u) << "no mapper was started again";
  mapping::MeshChunk other = chunk(0, 0);
  other.mesh.triangles.push_back({2, 1, 0});
  report("mapper.1", 12);
  rest_.send(channels::kMeshChunk, other);
  pass();
  EXPECT_EQ(look().at("tile/0/0/0").array<std::uint16_t>("indices").size(), 6u);
}

TEST_F(ViewerServiceTest, BeginsAnewWhenTheRunDoes) {
  for (int id = 0; id < 10; ++id) send_keyframe(id, at(id));
  pass();
  EXPECT_EQ(look().at("poses").array<std::int32_t>("ids").size(), 10u);
  builder_ = egraph::GraphBuilder(egraph::GraphBuilderOptions{});
  send_keyframe(0, at(0.0));  // sequence 0 after 90
  send_update();
  pass();
  const auto seen = look();
  EXPECT_EQ(seen.at("poses").array<std::int32_t>("ids"), std::vector<std::int32_t>{0});
  EXPECT_EQ(seen.at("scene").head["run"], 2 + 0);
}

TEST_F(ViewerServiceTest, KeepsToOneSessionUntilItIsSilent) {
  send_keyframe(0, at(0.0), 1);
  pass(kSecond);
  tracking::PoseEstimate other;
  other.header = {2, 0, 0};
  rest_.send(channels::kPose, other);
  pass(kSecond);
  EXPECT_EQ(look().at("camera").head["session"], 1);
  pass(5 * kSecond);
  rest_.send(channels::kPose, other);
  pass();
  EXPECT_EQ(look().at("camera").head["session"], 2);
}

TEST_F(ViewerServiceTest, SaysWhichServiceIsSilent) {
  messages::ServiceStatus status;
  status.pid = 1;
  for (int second = 0; second < 6; ++second) {
    status.utime = second * kSecond;
    status.frames = 30 * second;
    status.cpu_seconds = 0.5 * second;
    for (const char* name : {"tracker", "mapper"}) {
      status.service = name;
      if (second == 0 || name == std::string("tracker")) rest_.send(channels::kStatus, status);
    }
    pass(kSecond);
  }
  const auto bytes = look().at("health").arrays.at("json");
  const auto rows = nlohmann::json::parse(bytes);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["service"], "mapper");
  EXPECT_TRUE(rows[0]["silent"]);
  EXPECT_FALSE(rows[1]["silent"]);
  EXPECT_DOUBLE_EQ(rows[1]["rate"], 30.0);
  EXPECT_DOUBLE_EQ(rows[1]["cpu"], 0.5);

  // One that has said goodbye is not missed.
  status.service = "mapper";
  status.state = messages::kEndedState;
  rest_.send(channels::kStatus, status);
  pass(10 * kSecond);
  const auto later = nlohmann::json::parse(look().at("health").arrays.at("json"));
  EXPECT_EQ(later[0]["state"], "ended");
  EXPECT_FALSE(later[0]["silent"]);
  EXPECT_DOUBLE_EQ(later[0]["rate"], 0.0);
  EXPECT_TRUE(later[1]["silent"]);
}

TEST_F(ViewerServiceTest, SaysForHowLongNoFrameHasCome) {
  pass(9 * kSecond);
  EXPECT_DOUBLE_EQ(look().at("health").head["silence"], 0.0) << "nothing has begun";
  send_keyframe(0, {});
  pass(kSecond);
  pass(7 * kSecond);
  EXPECT_DOUBLE_EQ(look().at("health").head["silence"], 8.0);
}

TEST_F(ViewerServiceTest, CountsWhatIsNoMessageAndGoesOn) {
  for (const char* channel :
       {channels::kRgbd, channels::kFeatures, channels::kPose, channels::kGraphUpdate, channels::kGraphSnapshot,
        channels::kPoseCorrection, channels::kMeshChunk, channels::kStatus}) {
    rest_.send_bytes(channel, {1, 2, 3});
    rest_.send_bytes(channel, messages::Bytes(1000, 0xff));
  }
  pass();
  EXPECT_EQ(context_.status().status(0).rejected, 16);
  send_keyframe(0, at(0.0));
  pass();
  EXPECT_TRUE(look().contains("camera"));
}

TEST_F(ViewerServiceTest, SaysNothingButRequestsForTheGraph) {
  int heard = 0;
  transport::MemoryBus listener(network_);
  for (const char* channel : {channels::kAcknowledge, channels::kControl, channels::kControlReply, channels::kKeyframe,
                              channels::kPoseCorrection, channels::kMeshChunk, channels::kEndOfStream}) {
    ASSERT_TRUE(listener.subscribe(
        channel, [&](const transport::ReceivedMessage&) { ++heard; }, 0));
  }
  send_keyframe(0, at(0.0));
  send_update();
  for (int i = 0; i < 10; ++i) pass();
  while (listener.handle(0ms).value_or(0) > 0) {
  }
  EXPECT_EQ(heard, 0);
}

}  // namespace
}  // namespace eg::services
