#include "common/io/graph_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/geometry/so3.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::io {
namespace {

using egraph::DirectionKind;
using testing::HasSubstr;

egraph::GraphWithEdges small_graph() {
  egraph::GraphWithEdges graph;
  graph.session = 77;
  graph.version = 3;
  egraph::KeyframeNode keyframe;
  for (int i = 0; i < 2; ++i) {
    keyframe.id = {i};
    keyframe.sequence = 20 * i;
    keyframe.utime = 1341836537655662 + i;
    keyframe.world_from_camera = {geometry::so3_exp({0.1 * i, 0.2, 2.9}), {i / 3.0, -1.0, 2.5}};
    keyframe.covariance = egraph::Matrix6d::Identity() * 1e-6;
    keyframe.covariance(1, 4) = keyframe.covariance(4, 1) = -3e-8;
    graph.keyframes.push_back(keyframe);
  }
  const Eigen::Vector3d slanted = Eigen::Vector3d(1, 2, 3).normalized();
  const Eigen::Matrix3d covariance = 1e-4 * (Eigen::Matrix3d::Identity() - slanted * slanted.transpose());
  graph.landmarks = {{{4}, DirectionKind::plane_normal, slanted, covariance, 2, {0}, {1}},
                     {{9}, DirectionKind::vanishing_direction, Eigen::Vector3d::UnitX(), covariance, 2, {0}, {1}},
                     {{12}, DirectionKind::potential_direction, -Eigen::Vector3d::UnitZ(), covariance, 1, {1}, {1}}};
  graph.observations = {{{0}, {4}, slanted, covariance}, {{1}, {9}, Eigen::Vector3d::UnitY(), covariance}};
  graph.edges = {{{0}, {1}, {{4}, {9}}}};
  graph.covisibility = {{{0}, {1}, 120}};
  return graph;
}

TEST(GraphJson, WhatIsWrittenIsRead) {
  const egraph::GraphWithEdges graph = small_graph();
  const auto back = parse_graph(format_graph(graph));
  ASSERT_TRUE(back.has_value()) << back.error().message;
  ASSERT_EQ(back->keyframes.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto &a = graph.keyframes[i], &b = back->keyframes[i];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.sequence, b.sequence);
    EXPECT_EQ(a.utime, b.utime);
    EXPECT_EQ(a.world_from_camera.translation, b.world_from_camera.translation);
    EXPECT_LT((a.world_from_camera.rotation - b.world_from_camera.rotation).norm(), 1e-14);
    EXPECT_EQ(a.covariance, b.covariance);
  }
  ASSERT_EQ(back->landmarks.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto &a = graph.landmarks[i], &b = back->landmarks[i];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.direction, b.direction);
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.observations, b.observations);
    EXPECT_EQ(a.first_seen, b.first_seen);
    EXPECT_EQ(a.last_seen, b.last_seen);
  }
  ASSERT_EQ(back->observations.size(), 2U);
  EXPECT_EQ(back->observations[1].landmark, graph.observations[1].landmark);
  EXPECT_EQ(back->observations[0].direction_in_camera, graph.observations[0].direction_in_camera);
  ASSERT_EQ(back->edges.size(), 1U);
  EXPECT_EQ(back->edges[0].shared, graph.edges[0].shared);
  ASSERT_EQ(back->covisibility.size(), 1U);
  EXPECT_EQ(back->covisibility[0].shared_features, 120);
}

TEST(GraphJson, TextIsReadableAndWithoutSession) {
  const std::string text = format_graph(small_graph());
  EXPECT_THAT(text, testing::StartsWith("{\"version\": 1,\n\"keyframes\": [\n{\"id\":0,\"sequence\":0,"));
  EXPECT_THAT(text, HasSubstr("\"time_s\":1341836537.655662,"));
  EXPECT_THAT(text, HasSubstr("\"kind\":\"vanishing_direction\",\"direction\":[1.0,0.0,0.0],\"sigma_deg\":0.57295779"));
  EXPECT_THAT(text, HasSubstr("{\"first\":0,\"second\":1,\"landmarks\":[4,9]}"));
  EXPECT_THAT(text, HasSubstr("{\"first\":0,\"second\":1,\"shared_features\":120}"));
  egraph::GraphWithEdges other = small_graph();
  other.session = 78;
  other.version = 4;
  EXPECT_EQ(format_graph(other), text);
}

TEST(GraphJson, AnEmptyGraphIsFine) {
  const auto back = parse_graph(format_graph({}));
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_TRUE(back->keyframes.empty());
}

/// The error after replacing `what` by `with` in the small graph's text.
std::string error_with(const std::string& what, const std::string& with) {
  std::string text = format_graph(small_graph());
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  const auto graph = parse_graph(text.replace(at, what.size(), with));
  EXPECT_FALSE(graph.has_value()) << with;
  return graph ? "" : graph.error().message;
}

TEST(GraphJson, SaysWhatIsWrong) {
  EXPECT_EQ(parse_graph("{").error().message, "is no valid JSON");
  EXPECT_EQ(parse_graph("[]").error().message, "version: is missing");
  EXPECT_EQ(parse_graph("{\"version\": 1}").error().message, "keyframes: is missing");
  EXPECT_EQ(error_with("\"version\": 1", "\"version\": 2"), "version: must be 1");
  EXPECT_EQ(error_with("\"sequence\":20", "\"sequence\":-20"), "keyframes[1].sequence: is out of range");
  EXPECT_EQ(error_with("\"sequence\":20", "\"sequence\":2.5"), "keyframes[1].sequence: must be an integer");
  EXPECT_EQ(error_with("{\"id\":1,", "{\"id\":0,"), "keyframes[1].id: repeats an id");
  EXPECT_EQ(error_with("{\"id\":4,", "{"), "landmarks[0].id: is missing");
  EXPECT_EQ(error_with("\"direction\":[1.0,0.0,0.0]", "\"direction\":[1.0,0.0]"),
            "landmarks[1].direction: must be 3 numbers");
  EXPECT_EQ(error_with("\"direction\":[1.0,0.0,0.0]", "\"direction\":[1.0,0.5,0.0]"),
            "landmarks[1].direction: must be a unit vector");
  EXPECT_EQ(error_with("\"kind\":\"plane\"", "\"kind\":\"line\""),
            "landmarks[0].kind: must be plane, vanishing_direction or potential_direction");
  EXPECT_EQ(error_with("\"landmarks\":[4,9]", "\"landmarks\":[4,8]"),
            "edges[0].landmarks[1]: refers to a node that does not exist");
  EXPECT_EQ(error_with("\"shared_features\":120", "\"shared_features\":null"),
            "covisibility[0].shared_features: must be an integer");
}

TEST(GraphJson, ReadsAndWritesFiles) {
  test::TemporaryFolder folder;
  const auto path = folder.path() / "egraph.json";
  ASSERT_TRUE(write_graph(path, small_graph()).has_value());
  EXPECT_EQ(format_graph(*read_graph(path)).size(), format_graph(small_graph()).size());
  EXPECT_THAT(read_graph(folder.write("bad.json", "{}")).error().message, HasSubstr("bad.json: version: is missing"));
}

}  // namespace
}  // namespace eg::io
