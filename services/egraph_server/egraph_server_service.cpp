#include "services/egraph_server/egraph_server_service.hpp"

#include <chrono>
#include <string>

#include "common/io/graph_json.hpp"
#include "common/messages/channels.hpp"

namespace eg::services {
namespace {

/// A bus without authentication must not make the server hold any number of graphs.
constexpr std::size_t kMaxSessions = 64;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

EGraphServerService::EGraphServerService(service::ServiceContext& context, egraph::GraphBuilderOptions options)
    : context_(context), options_(options) {
  context_.subscribe<egraph::Keyframe>(messages::channels::kKeyframe, 0,
                                       [this](const egraph::Keyframe& keyframe) { on_keyframe(keyframe); });
  context_.subscribe<messages::GraphRequest>(messages::channels::kGraphRequest, 30,
                                             [this](const messages::GraphRequest& request) { on_request(request); });
}

void EGraphServerService::on_keyframe(const egraph::Keyframe& keyframe) {
  const auto start = std::chrono::steady_clock::now();
  const std::int64_t session = keyframe.header.session;
  if (!sessions_.contains(session) && sessions_.size() >= kMaxSessions) {
    context_.status().count_rejected("KEYFRAME: field 'session' is new and there are " + std::to_string(kMaxSessions) +
                                     " sessions already");
    return;
  }
  egraph::GraphBuilder& builder = sessions_.try_emplace(session, options_).first->second;
  const auto update = builder.add_keyframe(keyframe);
  if (!update) {
    context_.status().count_rejected("KEYFRAME: " + update.error().message);  // the tracker sends the missing one again
    return;
  }
  context_.publish(messages::channels::kGraphUpdate, *update);
  context_.status().count_frame(milliseconds_since(start));
}

void EGraphServerService::on_request(const messages::GraphRequest& request) {
  const auto found = sessions_.find(request.session);
  if (found == sessions_.end()) return;
  context_.publish(messages::channels::kGraphSnapshot, found->second.graph().snapshot(request.session));
}

base::Status EGraphServerService::save() {
  if (context_.options().out.empty()) return {};
  for (const auto& [session, builder] : sessions_) {
    const std::string name = sessions_.size() == 1 ? "egraph.json" : "egraph-" + std::to_string(session) + ".json";
    const auto written = io::write_graph(context_.options().out / name, builder.graph().snapshot(session));
    if (!written) return written;
  }
  return {};
}

}  // namespace eg::services
