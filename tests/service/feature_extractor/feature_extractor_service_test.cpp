#include "services/feature_extractor/feature_extractor_service.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/io/config.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/codec.hpp"
#include "common/synthetic/sequence.hpp"
#include "common/transport/memory_bus.hpp"
#include "services/feature_extractor/feature_extractor_config.hpp"

namespace eg::feature_extractor {
namespace {

image::RgbdFrame synthetic_frame(int index) {
  synthetic::SequenceOptions options;
  options.session = 7;
  options.camera.width = 320;  // quick
  options.camera.height = 240;
  options.camera.fx /= 2.0;
  options.camera.fy /= 2.0;
  options.camera.cx = (options.camera.cx - 0.5) / 2.0;
  options.camera.cy = (options.camera.cy - 0.5) / 2.0;
  return synthetic::SyntheticSequence::make(options).value().frame(index);
}

/// The service and, on a bus of its own, what it sends.
class FeatureExtractorServiceTest : public ::testing::Test {
 protected:
  FeatureExtractorServiceTest() {
    const auto subscribed = test_bus_.subscribe(
        messages::channels::kFeatures,
        [this](const transport::ReceivedMessage& message) {
          answers_.emplace_back(message.bytes.begin(), message.bytes.end());
        },
        0);
    EXPECT_TRUE(subscribed);
  }

  void send(const messages::Bytes& bytes) {
    ASSERT_TRUE(test_bus_.publish(messages::channels::kRgbd, bytes));
    ASSERT_TRUE(service_bus_.handle(std::chrono::milliseconds(0)));
    ASSERT_TRUE(test_bus_.handle(std::chrono::milliseconds(0)));
  }

  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus test_bus_{network_};
  transport::MemoryBus service_bus_{network_};
  service::ServiceContext context_{service_bus_, {"feature_extractor", {}, {}, {}, {}, true}};
  FeatureExtractorService service_{context_, {}};
  std::vector<messages::Bytes> answers_;
};

TEST_F(FeatureExtractorServiceTest, AnswersAFrameWithItsFeatures) {
  send(messages::encode(synthetic_frame(3)));

  ASSERT_EQ(answers_.size(), 1U);
  const auto features = messages::decode<features::FrameFeatures>(answers_[0]);
  ASSERT_TRUE(features) << features.error().message;
  EXPECT_EQ(features->header.session, 7);
  EXPECT_EQ(features->header.sequence, 3);
  EXPECT_GT(features->points.size(), 100U);
  EXPECT_GT(features->lines.size(), 5U);
  EXPECT_GE(features->planes.size(), 1U);
  EXPECT_GE(features->directions.size(), 2U);
}

TEST_F(FeatureExtractorServiceTest, AnswersARepeatedFrameAgainWithTheSameBytes) {
  const messages::Bytes first = messages::encode(synthetic_frame(0));
  send(first);
  send(messages::encode(synthetic_frame(1)));
  send(first);

  ASSERT_EQ(answers_.size(), 3U);
  EXPECT_EQ(answers_[2], answers_[0]);
  EXPECT_NE(answers_[1], answers_[0]);
  EXPECT_EQ(context_.status().status(0).frames, 2) << "the repetition is not computed";
}

TEST_F(FeatureExtractorServiceTest, CountsGapsInTheStreamUnlessWhatIsMissingComesAgain) {
  service::ServiceContext real_time{service_bus_, {"feature_extractor", {}, {}, {}, {}, false}};
  const FeatureExtractorService other{real_time, {}};
  send(messages::encode(synthetic_frame(0)));
  send(messages::encode(synthetic_frame(3)));
  EXPECT_EQ(real_time.status().status(0).dropped, 2);
  EXPECT_EQ(context_.status().status(0).dropped, 0) << "lockstep";
}

TEST_F(FeatureExtractorServiceTest, RejectsBytesThatAreNoFrame) {
  send({1, 2, 3});
  EXPECT_TRUE(answers_.empty());
  EXPECT_EQ(context_.status().status(0).rejected, 1);
}

TEST_F(FeatureExtractorServiceTest, AnImageThatCannotBeDecodedIsAFrameWithoutFeatures) {
  messages::CompressedFrame frame = messages::compress(synthetic_frame(3));
  frame.depth.resize(frame.depth.size() / 2);
  send(messages::encode(frame));
  EXPECT_EQ(context_.status().status(0).rejected, 1);

  ASSERT_EQ(answers_.size(), 1U);
  const auto features = messages::decode<features::FrameFeatures>(answers_[0]);
  ASSERT_TRUE(features) << features.error().message;
  EXPECT_EQ(features->header.sequence, frame.header.sequence);
  EXPECT_EQ(features->header.utime, frame.header.utime);
  EXPECT_TRUE(features->points.empty() && features->lines.empty() && features->planes.empty());
}

TEST(FeatureExtractorConfigTest, ReadsEverySectionAndRefusesUnknownKeys) {
  features::FeatureExtractorOptions options;
  io::ConfigSchema schema;
  describe_options(schema, options);
  ASSERT_TRUE(io::parse_config("points: {max_points: 300}\nlines: {detector: lsd}\n", "test.yaml", schema));
  EXPECT_EQ(options.points.detector.max_points, 300);
  EXPECT_EQ(options.lines.detector.kind, features::LineDetectorKind::lsd);

  const auto status = io::parse_config("lines: {min_lenght: 0.1}\n", "test.yaml", schema);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("min_length"), std::string::npos) << status.error().message;
}

TEST(FeatureExtractorConfigTest, EveryDefaultIsWithinItsRange) {
  features::FeatureExtractorOptions options;
  io::ConfigSchema schema;
  describe_options(schema, options);
  const auto status = io::parse_config(io::print_config(schema), "printed.yaml", schema);
  EXPECT_TRUE(status) << status.error().message;
}

}  // namespace
}  // namespace eg::feature_extractor
