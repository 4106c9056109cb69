#include "services/egraph_server/egraph_server_service.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <string>
#include <utility>

#include "common/io/graph_json.hpp"
#include "common/messages/channels.hpp"

namespace eg::services {
namespace {

/// A bus without authentication must not make the server hold any number of graphs.
constexpr std::size_t kMaxSessions = 64;

/// Edges in egraph.json, roughly: all of them up to a thousand keyframes.
constexpr std::size_t kMaxEdges = 500'000;

egraph::GraphWithEdges file_of(const egraph::Graph& graph, std::int64_t session) {
  const std::size_t keyframes = std::max<std::size_t>(graph.keyframes().size(), 1);
  return {graph.snapshot(session), graph.edges(std::max<std::size_t>(2 * kMaxEdges / keyframes, 16))};
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

EGraphServerService::EGraphServerService(service::ServiceContext& context, egraph::GraphBuilderOptions options,
                                         std::filesystem::path state, GraphStoreOptions store)
    : context_(context), options_(options), state_(std::move(state)), store_options_(store) {
  context_.subscribe<egraph::Keyframe>(messages::channels::kKeyframe, service::kStateQueue,
                                       [this](const egraph::Keyframe& keyframe) { on_keyframe(keyframe); });
  context_.subscribe<messages::GraphRequest>(messages::channels::kGraphRequest, 30,
                                             [this](const messages::GraphRequest& request) { on_request(request); });
  context_.subscribe<egraph::GraphSnapshot>(messages::channels::kRestore, service::kStateQueue,
                                            [this](const egraph::GraphSnapshot& part) { on_restore(part); });
}

base::Result<EGraphServerService::Session*> EGraphServerService::open(std::int64_t id) {
  if (const auto known = sessions_.find(id); known != sessions_.end()) return &known->second;
  if (sessions_.size() >= kMaxSessions) {
    return base::fail("field 'session' is new and there are " + std::to_string(kMaxSessions) + " sessions already");
  }
  auto session = read(id);
  if (!session) return tl::make_unexpected(session.error());
  return &sessions_.emplace(id, *std::move(session)).first->second;
}

base::Result<EGraphServerService::Session> EGraphServerService::read(std::int64_t id) const {
  Session session{egraph::GraphBuilder(options_), {}, {}, false};
  if (!state_.empty()) {
    session.store.emplace(state_, id, store_options_);
    auto stored = session.store->load();
    if (!stored) return tl::make_unexpected(stored.error());
    if (!stored->warning.empty()) spdlog::warn(stored->warning);
    session.builder = egraph::GraphBuilder(options_, std::move(stored->state));
  }
  return session;
}

bool EGraphServerService::is_kept(std::int64_t id) const {
  return sessions_.contains(id) || (!state_.empty() && GraphStore(state_, id).exists());
}

void EGraphServerService::on_keyframe(const egraph::Keyframe& keyframe) {
  const auto start = std::chrono::steady_clock::now();
  const std::int64_t id = keyframe.header.session;
  const auto session = open(id);
  if (!session) return context_.status().count_rejected("KEYFRAME: " + session.error().message);
  egraph::GraphBuilder& builder = (*session)->builder;
  const egraph::Arrival arrival = builder.arrival_of(keyframe);
  const auto update = builder.add_keyframe(keyframe);
  if (update) {
    const auto kept = (*session)->store ? (*session)->store->append(*update, builder) : base::Status();
    if (!kept) {
      return context_.status().count_rejected("KEYFRAME: " + kept.error().message);  // it will come again
    }
    context_.publish(messages::channels::kGraphUpdate, *update);
    context_.status().count_frame(milliseconds_since(start));
  } else if (arrival == egraph::Arrival::repeated) {
    publish_snapshot(id, builder.graph());
  } else if (arrival == egraph::Arrival::early) {
    // Its predecessor was lost and will come again, unless the tracker goes on in a map that was loaded, or had an
    // answer from a server that is no more.
    (*session)->asked_to_restore = true;
    context_.publish(messages::channels::kRestoreRequest, messages::GraphRequest{id, builder.graph().version()});
  } else {
    context_.status().count_rejected("KEYFRAME: " + update.error().message);
  }
}

void EGraphServerService::on_request(const messages::GraphRequest& request) {
  if (!is_kept(request.session)) return;
  const auto session = open(request.session);
  if (!session) return context_.status().count_rejected("EGRAPH_REQUEST: " + session.error().message);
  const egraph::GraphBuilder& builder = (*session)->builder;
  const std::deque<egraph::GraphUpdate>& recent = builder.recent_updates();
  const bool newcomer = request.have_version == 0;
  if (newcomer || recent.empty() || request.have_version < recent.front().base_version) {
    publish_snapshot(request.session, builder.graph());
    return;
  }
  for (const egraph::GraphUpdate& update : recent) {
    if (update.base_version >= request.have_version) context_.publish(messages::channels::kGraphUpdate, update);
  }
}

void EGraphServerService::on_restore(const egraph::GraphSnapshot& part) {
  const auto found = sessions_.find(part.session);
  if (found == sessions_.end()) return;
  Session& session = found->second;
  if (!session.asked_to_restore || part.version <= session.builder.graph().version()) return;
  const auto snapshot = session.restore.add(part);
  if (!snapshot) return;
  egraph::BuilderState state;
  auto taken = state.reset(*snapshot);
  if (taken && session.store) taken = session.store->replace(state.graph);
  if (!taken) return context_.status().count_rejected("EGRAPH_RESTORE: " + taken.error().message);
  session.builder = egraph::GraphBuilder(options_, std::move(state));
  session.asked_to_restore = false;
}

void EGraphServerService::publish_snapshot(std::int64_t session, const egraph::Graph& graph) {
  for (const egraph::GraphSnapshot& part : egraph::split(graph.snapshot(session))) {
    context_.publish(messages::channels::kGraphSnapshot, part);
  }
}

base::Status EGraphServerService::save() {
  if (context_.options().out.empty()) return {};
  // A server that was killed after a session's last keyframe has not heard of it since. There may be any number of such
  // sessions: each is read for as long as its file takes.
  std::set<std::int64_t> ids;
  for (const auto& [id, session] : sessions_) ids.insert(id);
  for (const std::int64_t id : GraphStore::sessions_in(state_)) ids.insert(id);
  const auto write = [&](std::int64_t id, const Session& session) {
    const std::string name = ids.size() == 1 ? "egraph.json" : "egraph-" + std::to_string(id) + ".json";
    return io::write_graph(context_.options().out / name, file_of(session.builder.graph(), id));
  };
  for (const std::int64_t id : ids) {
    const auto served = sessions_.find(id);
    const auto written = served != sessions_.end()
                             ? write(id, served->second)
                             : read(id).and_then([&](const Session& kept) { return write(id, kept); });
    if (!written) return written;
  }
  return {};
}

}  // namespace eg::services
