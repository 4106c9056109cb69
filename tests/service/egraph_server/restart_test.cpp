#include <fstream>

#include "common/io/text_file.hpp"
#include "tests/service/egraph_server/server_rig.hpp"

namespace eg::services {
namespace {

constexpr char kJournal[] = "graph-1.journal";

egraph::GraphSnapshot whole(const std::vector<egraph::GraphSnapshot>& parts) {
  egraph::SnapshotAssembler assembler;
  std::optional<egraph::GraphSnapshot> snapshot;
  for (const egraph::GraphSnapshot& part : parts) snapshot = assembler.add(part);
  EXPECT_TRUE(snapshot.has_value());
  return snapshot.value_or(egraph::GraphSnapshot{});
}

class RestartedServer : public EGraphServer {
 protected:
  messages::Bytes graph_of_server() {
    snapshots_->clear();
    ask(1);
    return messages::encode(whole(*snapshots_));
  }
  void change_file(const std::function<void(std::string&)>& change) {
    std::string bytes = io::read_file(file(kJournal)).value();
    change(bytes);
    std::ofstream(file(kJournal), std::ios::binary | std::ios::trunc) << bytes;
  }
};

TEST_F(RestartedServer, GoesOnWhereItWasKilled) {
  for (int id = 0; id < 3; ++id) send(keyframe(1, id));
  const messages::Bytes before = graph_of_server();
  restart();
  EXPECT_EQ(graph_of_server(), before);
  send(keyframe(1, 3));
  EXPECT_EQ(status().rejected, 0) << status().last_rejection;
  ASSERT_EQ(updates_->size(), 4U);
  EXPECT_EQ(updates_->back().base_version, 3);

  EGraphServer::restart();
  send(keyframe(1, 4));
  EXPECT_EQ(updates_->back().base_version, 4) << "the second life is kept too";
}

TEST_F(RestartedServer, IsTheSameAsOneThatWasNeverKilled) {
  for (int id = 0; id < 20; ++id) {
    send(keyframe(1, id));
    send(keyframe(2, id));  // the same in session 2, but the server is killed all the time
    if (id % 3 == 0) restart();
  }
  std::vector<messages::Bytes> disturbed;
  for (egraph::GraphUpdate update : *updates_) {
    update.session = 0;
    disturbed.push_back(messages::encode(update));
  }
  egraph::GraphBuilder undisturbed;
  for (int id = 0; id < 20; ++id) {
    const messages::Bytes expected = messages::encode(undisturbed.add_keyframe(keyframe(0, id)).value());
    EXPECT_EQ(disturbed[static_cast<std::size_t>(2 * id)], expected);
    EXPECT_EQ(disturbed[static_cast<std::size_t>(2 * id + 1)], expected);
  }
}

TEST_F(RestartedServer, RewritesAJournalThatHasGrownAndLosesNothing) {
  constexpr int kKeyframes = 280;  // several times the answers that are kept to be given again
  set_store_options({.compaction_bytes = 150'000});
  restart();
  egraph::GraphBuilder undisturbed;
  std::uintmax_t bytes_before = 0;
  int rewritten = 0;
  for (int id = 0; id < kKeyframes; ++id) {
    send(keyframe(1, id));
    const messages::Bytes expected = messages::encode(undisturbed.add_keyframe(keyframe(1, id)).value());
    ASSERT_EQ(messages::encode(updates_->back()), expected) << "keyframe " << id;
    const bool is_shorter = std::filesystem::file_size(file(kJournal)) < bytes_before;
    bytes_before = std::filesystem::file_size(file(kJournal));
    if (!is_shorter && id % 40 != 0) continue;
    rewritten += is_shorter ? 1 : 0;
    restart();
    send(keyframe(1, id));
    EXPECT_EQ(messages::encode(updates_->back()), expected) << "the answer to keyframe " << id << " is given again";
    if (id == 0) continue;
    send(keyframe(1, id - 1));
    EXPECT_EQ(updates_->back().keyframe.id.value, id - 1) << "and the one before";
  }
  EXPECT_EQ(rewritten, 1);
  EXPECT_EQ(graph_of_server(), messages::encode(undisturbed.graph().snapshot(1)));
}

TEST_F(RestartedServer, RepeatsTheAnswersOfItsFirstLife) {
  for (int id = 0; id < 3; ++id) send(keyframe(1, id));
  restart();
  send(keyframe(1, 2));
  ASSERT_EQ(updates_->size(), 4U);
  EXPECT_EQ(messages::encode(updates_->back()), messages::encode((*updates_)[2]));
}

TEST_F(RestartedServer, SavesGraphsThatItHasNotHeardOfSince) {
  for (int id = 0; id < 3; ++id) send(keyframe(1, id));
  ASSERT_TRUE(service_->save());
  const std::string before = io::read_file(file("egraph.json")).value();
  std::filesystem::remove(file("egraph.json"));
  restart();
  ASSERT_TRUE(service_->save());
  EXPECT_EQ(io::read_file(file("egraph.json")).value(), before);
}

TEST_F(RestartedServer, SavesMoreSessionsThanItServesAtOnce) {
  constexpr int kSessions = 66;
  for (int session = 1; session <= kSessions; ++session) {
    if (session % 40 == 0) restart();
    send(keyframe(session, 0));
  }
  EXPECT_EQ(status().rejected, 0) << status().last_rejection;
  const base::Status saved = service_->save();
  ASSERT_TRUE(saved) << saved.error().message;
  for (int session = 1; session <= kSessions; ++session) {
    EXPECT_TRUE(written(("egraph-" + std::to_string(session) + ".json").c_str())) << session;
  }
  send(keyframe(1, 1));
  EXPECT_EQ(status().rejected, 0) << "saving took the place of a session: " << status().last_rejection;
}

TEST_F(RestartedServer, AWriteThatWasCutShortCostsOneKeyframe) {
  for (int id = 0; id < 3; ++id) send(keyframe(1, id));
  change_file([](std::string& bytes) { bytes.resize(bytes.size() - 5); });
  restart();
  send(keyframe(1, 2));  // not yet confirmed, had it really been cut short
  EXPECT_EQ(status().rejected, 0) << status().last_rejection;
  EXPECT_EQ(messages::encode(updates_->back()), messages::encode((*updates_)[2])) << "computed again, the same";
  EXPECT_TRUE(written("graph-1.journal.damaged"));
  const messages::Bytes before = graph_of_server();
  restart();
  EXPECT_EQ(graph_of_server(), before);
}

TEST_F(RestartedServer, TakesTheReplicaOfTheTrackerWhenItsFileIsGone) {
  egraph::Graph replica;
  for (int id = 0; id < 3; ++id) send(keyframe(1, id));
  for (const egraph::GraphUpdate& update : *updates_) ASSERT_TRUE(replica.apply(update).has_value());
  std::filesystem::remove(file(kJournal));
  restart();
  send(keyframe(1, 3));
  ASSERT_EQ(restore_requests_->size(), 1U) << "keyframe 3 follows on what the server does not have";
  EXPECT_EQ(restore_requests_->back().session, 1);
  EXPECT_EQ(restore_requests_->back().have_version, 0);
  for (const egraph::GraphSnapshot& part : egraph::split(replica.snapshot(1), 500)) {
    peer_.send(channels::kRestore, part);
  }
  settle();
  send(keyframe(1, 3));
  ASSERT_EQ(updates_->size(), 4U);
  EXPECT_TRUE(replica.apply(updates_->back()).has_value());
  restart();
  EXPECT_EQ(graph_of_server(), messages::encode(replica.snapshot(1))) << "what was restored is kept";
}

TEST_F(RestartedServer, TakesNoReplicaThatItDidNotAskFor) {
  egraph::GraphBuilder other;
  for (int id = 0; id < 9; ++id) ASSERT_TRUE(other.add_keyframe(keyframe(1, id)).has_value());
  send(keyframe(1, 0));
  peer_.send(channels::kRestore, other.graph().snapshot(1));
  settle();
  send(keyframe(1, 1));
  EXPECT_EQ(updates_->back().version, 2);
}

TEST_F(RestartedServer, LateJoinersGetTheGraphOfAFormerLife) {
  for (int id = 0; id < 3; ++id) send(keyframe(1, id));
  restart();
  ask(1);
  EXPECT_EQ(whole(*snapshots_).keyframes.size(), 3U) << "before any keyframe of this life";
}

TEST_F(RestartedServer, NamesAJournalThatItCannotRead) {
  send(keyframe(1, 0));
  ASSERT_TRUE(GraphStore::prepare_folder(folder_.path()).has_value());
  change_file([](std::string& bytes) { bytes[7] = 9; });
  const auto refused = GraphStore::prepare_folder(folder_.path());
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().message.find("graph-1.journal: is a journal of format version 9, not 1"), std::string::npos)
      << refused.error().message;
  restart();
  send(keyframe(1, 1));
  EXPECT_NE(status().last_rejection.find("graph-1.journal"), std::string::npos) << status().last_rejection;
}

TEST_F(RestartedServer, RefusesAJournalOfAnotherSession) {
  send(keyframe(1, 0));
  std::filesystem::rename(file(kJournal), file("graph-2.journal"));
  restart();
  send(keyframe(2, 0));
  EXPECT_NE(status().last_rejection.find("graph-2.journal: record 0: belongs to session 1, not 2"), std::string::npos)
      << status().last_rejection;
}

TEST_F(RestartedServer, AnswersNothingThatItCouldNotKeep) {
  send(keyframe(1, 0));
  std::filesystem::remove_all(folder_.path());
  send(keyframe(2, 0));
  EXPECT_EQ(updates_->size(), 1U);
  EXPECT_NE(status().last_rejection.find("graph-2.journal: cannot be written"), std::string::npos)
      << status().last_rejection;
  std::filesystem::create_directories(folder_.path());
  send(keyframe(2, 0));
  EXPECT_EQ(updates_->size(), 2U) << "the tracker announces it again";
}

}  // namespace
}  // namespace eg::services
