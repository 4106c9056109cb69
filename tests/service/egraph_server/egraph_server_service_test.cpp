#include "services/egraph_server/egraph_server_service.hpp"

#include "common/io/graph_json.hpp"
#include "tests/service/egraph_server/server_rig.hpp"

namespace eg::services {
namespace {

TEST_F(EGraphServer, AnswersEveryKeyframeWithAnUpdate) {
  egraph::Graph replica;
  for (int id = 0; id < 4; ++id) {
    send(keyframe(1, id));
    ASSERT_EQ(updates_->size(), static_cast<std::size_t>(id + 1));
    EXPECT_EQ(updates_->back().session, 1);
    EXPECT_EQ(updates_->back().keyframe.id, egraph::KeyframeId{id});
    EXPECT_TRUE(replica.apply(updates_->back()).has_value());
  }
  EXPECT_EQ(replica.version(), 4);
  EXPECT_EQ(replica.landmarks().size(), 3U);
  EXPECT_EQ(replica.edges().size(), 6U) << "every keyframe with every other";
  EXPECT_EQ(status().frames, 4);
  EXPECT_TRUE(snapshots_->empty());
}

TEST_F(EGraphServer, ARepeatedKeyframeGetsTheSameAnswer) {
  send(keyframe(1, 0));
  send(keyframe(1, 1));
  send(keyframe(1, 0));
  ASSERT_EQ(updates_->size(), 3U);
  EXPECT_EQ(messages::encode((*updates_)[2]), messages::encode((*updates_)[0]));
}

TEST_F(EGraphServer, AKeyframeThatComesTooEarlyMakesItAskForTheGraph) {
  send(keyframe(1, 0));
  send(keyframe(1, 2));
  EXPECT_EQ(updates_->size(), 1U);
  ASSERT_EQ(restore_requests_->size(), 1U);
  EXPECT_EQ(restore_requests_->back().have_version, 1);
  EXPECT_EQ(status().rejected, 0) << "no mistake of anybody's";
  send(keyframe(1, 1));
  send(keyframe(1, 2));
  EXPECT_EQ(updates_->size(), 3U);
}

TEST_F(EGraphServer, AnswersARequestWithTheWholeGraph) {
  send(keyframe(1, 0));
  send(keyframe(1, 1));
  ask(1);
  ASSERT_EQ(snapshots_->size(), 1U);
  const egraph::GraphSnapshot& snapshot = snapshots_->front();
  EXPECT_EQ(snapshot.session, 1);
  EXPECT_EQ(snapshot.version, 2);
  EXPECT_EQ(snapshot.keyframes.size(), 2U);
  EXPECT_EQ(snapshot.landmarks.size(), 3U);
  EXPECT_EQ(snapshot.observations.size(), 6U);
  EXPECT_EQ(snapshot.covisibility.size(), 1U);

  // A late joiner goes on from there.
  egraph::Graph replica;
  replica.reset(snapshot);
  send(keyframe(1, 2));
  EXPECT_TRUE(replica.apply(updates_->back()).has_value());
}

TEST_F(EGraphServer, AReceiverThatMissedAFewUpdatesGetsThoseAgain) {
  for (int id = 0; id < 6; ++id) send(keyframe(1, id));
  const std::vector<egraph::GraphUpdate> first = *updates_;
  updates_->clear();
  ask(1, 4);
  EXPECT_TRUE(snapshots_->empty());
  ASSERT_EQ(updates_->size(), 2U);
  EXPECT_EQ(messages::encode((*updates_)[0]), messages::encode(first[4]));
  EXPECT_EQ(messages::encode((*updates_)[1]), messages::encode(first[5]));
}

TEST_F(EGraphServer, ALargeGraphComesInParts) {
  for (int id = 0; id < 300; ++id) send(keyframe(1, id));
  ask(1);
  EXPECT_GT(snapshots_->size(), 1U);
  egraph::SnapshotAssembler assembler;
  std::optional<egraph::GraphSnapshot> whole;
  for (const egraph::GraphSnapshot& part : *snapshots_) {
    EXPECT_LT(messages::encode(part).size(), 130'000U);
    EXPECT_FALSE(whole.has_value());
    whole = assembler.add(part);
  }
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->keyframes.size(), 300U);
  EXPECT_EQ(whole->observations.size(), 900U);
}

TEST_F(EGraphServer, KnowsNothingOfAnUnknownSession) {
  send(keyframe(1, 0));
  ask(2);
  EXPECT_TRUE(snapshots_->empty());
}

TEST_F(EGraphServer, SessionsDoNotMix) {
  send(keyframe(1, 0));
  send(keyframe(7, 0));
  send(keyframe(1, 1));
  send(keyframe(7, 1));
  send(keyframe(1, 2));
  ask(1);
  ask(7);
  ASSERT_EQ(snapshots_->size(), 2U);
  EXPECT_EQ((*snapshots_)[0].keyframes.size(), 3U);
  EXPECT_EQ((*snapshots_)[1].keyframes.size(), 2U);
  EXPECT_EQ((*snapshots_)[1].session, 7);
  EXPECT_EQ((*snapshots_)[1].landmarks.front().id, egraph::LandmarkId{0}) << "its own numbers";
}

TEST_F(EGraphServer, RefusesAnotherRecordingUnderTheSameSession) {
  for (int id = 0; id < 3; ++id) send(keyframe(1, id));
  egraph::Keyframe other = keyframe(1, 0);
  other.header.utime += 5'000'000;
  send(other);
  EXPECT_EQ(updates_->size(), 3U);
  EXPECT_NE(status().last_rejection.find("keyframe 0 is not the one that the graph of session 1 holds"),
            std::string::npos)
      << status().last_rejection;
}

TEST_F(EGraphServer, BoundsTheNumberOfSessions) {
  for (int session = 0; session < 64; ++session) send(keyframe(session, 0));
  EXPECT_EQ(updates_->size(), 64U);
  send(keyframe(64, 0));
  EXPECT_EQ(updates_->size(), 64U);
  EXPECT_EQ(status().rejected, 1);
  EXPECT_NE(status().last_rejection.find("session"), std::string::npos) << status().last_rejection;
  send(keyframe(63, 1));
  EXPECT_EQ(updates_->size(), 65U) << "those that are known go on";
}

TEST_F(EGraphServer, SavesTheGraph) {
  ASSERT_TRUE(service_->save().has_value());
  EXPECT_FALSE(written("egraph.json")) << "there is none";
  send(keyframe(1, 0));
  send(keyframe(1, 1));
  ASSERT_TRUE(service_->save().has_value());
  const auto graph = io::read_graph(folder_.path() / "egraph.json");
  ASSERT_TRUE(graph.has_value()) << graph.error().message;
  EXPECT_EQ(graph->keyframes.size(), 2U);
  EXPECT_EQ(graph->edges.size(), 1U);
}

TEST_F(EGraphServer, SavesSeveralSessionsSeparately) {
  send(keyframe(1, 0));
  send(keyframe(7, 0));
  ASSERT_TRUE(service_->save().has_value());
  EXPECT_TRUE(written("egraph-1.json"));
  EXPECT_TRUE(written("egraph-7.json"));
}

TEST_F(EGraphServer, SurvivesNonsense) {
  peer_.send_bytes(channels::kKeyframe, {1, 2, 3});
  peer_.send_bytes(channels::kGraphRequest, {});
  egraph::Keyframe broken = keyframe(1, 0);
  broken.directions[0].direction = {std::nan(""), 0, 0};
  peer_.send(channels::kKeyframe, broken);
  settle();
  EXPECT_TRUE(updates_->empty());
  EXPECT_EQ(status().rejected, 3);
  send(keyframe(1, 0));
  EXPECT_EQ(updates_->size(), 1U);
}

}  // namespace
}  // namespace eg::services
