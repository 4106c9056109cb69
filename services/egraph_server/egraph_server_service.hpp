#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>

#include "common/egraph/graph_builder.hpp"
#include "common/egraph/snapshot_parts.hpp"
#include "common/service/service.hpp"
#include "services/egraph_server/graph_store.hpp"

namespace eg::services {

/// The authority on the graphs, one per session. Answers every KEYFRAME with an EGRAPH_UPDATE and every EGRAPH_REQUEST
/// with what the asker lacks: the latest updates, or a snapshot. A keyframe whose predecessors it does not know makes
/// it ask the tracker for its replica. With a state folder every update is on the disk before it is sent, and a session
/// is read from there when its first message comes.
class EGraphServerService : public service::Service {
 public:
  /// `state`: the folder of the journals; empty: nothing is kept.
  EGraphServerService(service::ServiceContext& context, egraph::GraphBuilderOptions options,
                      std::filesystem::path state = {}, GraphStoreOptions store = {});

  /// Writes egraph.json, or egraph-<session>.json for each of several sessions, also of those that were not heard of
  /// since the server was started.
  base::Status save() override;

 private:
  struct Session {
    egraph::GraphBuilder builder;
    std::optional<GraphStore> store;
    egraph::SnapshotAssembler restore;
    bool asked_to_restore = false;  ///< what nobody asked for is not taken
  };

  void on_keyframe(const egraph::Keyframe& keyframe);
  void on_request(const messages::GraphRequest& request);
  void on_restore(const egraph::GraphSnapshot& part);
  /// The session, read from the disk or new.
  base::Result<Session*> open(std::int64_t id);
  /// The same, without making it one of those that are served.
  [[nodiscard]] base::Result<Session> read(std::int64_t id) const;
  [[nodiscard]] bool is_kept(std::int64_t id) const;
  void publish_snapshot(std::int64_t session, const egraph::Graph& graph);

  service::ServiceContext& context_;
  egraph::GraphBuilderOptions options_;
  std::filesystem::path state_;
  GraphStoreOptions store_options_;
  std::map<std::int64_t, Session> sessions_;
};

}  // namespace eg::services
