#pragma once

#include <cstdint>
#include <map>

#include "common/egraph/graph_builder.hpp"
#include "common/service/service.hpp"

namespace eg::services {

/// Answers every KEYFRAME with an EGRAPH_UPDATE and every EGRAPH_REQUEST with a snapshot. One graph per session.
class EGraphServerService : public service::Service {
 public:
  EGraphServerService(service::ServiceContext& context, egraph::GraphBuilderOptions options);

  /// Writes egraph.json, or egraph-<session>.json for each of several sessions.
  base::Status save() override;

 private:
  void on_keyframe(const egraph::Keyframe& keyframe);
  void on_request(const messages::GraphRequest& request);

  service::ServiceContext& context_;
  egraph::GraphBuilderOptions options_;
  std::map<std::int64_t, egraph::GraphBuilder> sessions_;
};

}  // namespace eg::services
