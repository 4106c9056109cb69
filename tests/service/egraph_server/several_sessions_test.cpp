// Trackers of several sessions and a late viewer at one server, over a network that loses, doubles and reorders, while
// the server is killed and once loses its disk.
#include "tests/service/egraph_server/server_rig.hpp"

namespace eg::services {
namespace {

constexpr int kKeyframes = 40;

/// What a tracker does about the graph: announces keyframes in order, each until it is in the replica.
class Robot {
 public:
  Robot(const std::shared_ptr<transport::MemoryNetwork>& network, std::int64_t session)
      : peer_(network),
        session_(session),
        updates_(peer_.collect<egraph::GraphUpdate>(channels::kGraphUpdate)),
        parts_(peer_.collect<egraph::GraphSnapshot>(channels::kGraphSnapshot)),
        requests_(peer_.collect<messages::GraphRequest>(channels::kRestoreRequest)) {}

  [[nodiscard]] const egraph::Graph& replica() const { return replica_; }
  [[nodiscard]] bool done() const { return replica_.keyframes().size() == kKeyframes; }
  [[nodiscard]] std::int64_t session() const { return session_; }

  void step() {
    peer_.handle();
    for (const egraph::GraphUpdate& update : *updates_) {
      if (update.session == session_ && !replica_.apply(update)) ask();
    }
    for (const egraph::GraphSnapshot& part : *parts_) take(part);
    for (const messages::GraphRequest& request : *requests_) restore(request);
    updates_->clear();
    parts_->clear();
    requests_->clear();
    if (!done()) peer_.send(channels::kKeyframe, keyframe(session_, static_cast<int>(replica_.keyframes().size())));
  }

  void ask() { peer_.send(channels::kGraphRequest, messages::GraphRequest{session_, replica_.version()}); }

 private:
  void take(const egraph::GraphSnapshot& part) {
    if (part.session != session_ || part.version <= replica_.version()) return;
    const auto whole = assembler_.add(part);
    if (whole) {
      ASSERT_TRUE(replica_.reset(*whole).has_value());
    }
  }

  void restore(const messages::GraphRequest& request) {
    if (request.session != session_ || request.have_version >= replica_.version()) return;
    for (const auto& part : egraph::split(replica_.snapshot(session_), 5'000)) peer_.send(channels::kRestore, part);
  }

  test::BusPeer peer_;
  std::int64_t session_;
  egraph::Graph replica_;
  egraph::SnapshotAssembler assembler_;
  test::Inbox<egraph::GraphUpdate> updates_;
  test::Inbox<egraph::GraphSnapshot> parts_;
  test::Inbox<messages::GraphRequest> requests_;
};

class SeveralSessions : public EGraphServer {
 protected:
  SeveralSessions()
      : EGraphServer(
            transport::MemoryNetwork::Disturbance{.loss = 0.2, .duplication = 0.1, .reordering = 0.1, .seed = 5}) {}

  void step(std::vector<std::unique_ptr<Robot>>& robots) {
    for (const auto& robot : robots) robot->step();
    bus_->handle(std::chrono::milliseconds(0));
    peer_.handle();
  }

  static messages::Bytes expected(std::int64_t session) {
    egraph::GraphBuilder builder;
    for (int id = 0; id < kKeyframes; ++id) EXPECT_TRUE(builder.add_keyframe(keyframe(session, id)).has_value());
    return messages::encode(builder.graph().snapshot(session));
  }
};

TEST_F(SeveralSessions, EndWithTheGraphThatAnUndisturbedServerMakes) {
  std::vector<std::unique_ptr<Robot>> robots;
  for (const std::int64_t session : {1, 2, 7}) robots.push_back(std::make_unique<Robot>(network_, session));
  const auto all_done = [&] {
    return std::all_of(robots.begin(), robots.end(), [](const auto& r) { return r->done(); });
  };
  int round = 0;
  for (; round < 5'000 && !all_done(); ++round) {
    if (round % 17 == 16) restart();
    if (round == 60) {  // a new machine
      for (const char* name : {"graph-1.journal", "graph-2.journal", "graph-7.journal"}) {
        std::filesystem::remove(file(name));
      }
      restart();
    }
    step(robots);
  }
  ASSERT_TRUE(all_done()) << "after " << round << " rounds";
  for (const auto& robot : robots) {
    EXPECT_EQ(messages::encode(robot->replica().snapshot(robot->session())), expected(robot->session()));
  }

  // A viewer comes late, through the same network.
  std::vector<std::unique_ptr<Robot>> viewers;
  viewers.push_back(std::make_unique<Robot>(network_, 2));
  for (round = 0; round < 500 && !viewers.front()->done(); ++round) {
    viewers.front()->ask();
    step(viewers);
  }
  EXPECT_EQ(messages::encode(viewers.front()->replica().snapshot(2)), expected(2));
}

}  // namespace
}  // namespace eg::services
