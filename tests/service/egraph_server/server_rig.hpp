#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "common/messages/channels.hpp"
#include "services/egraph_server/egraph_server_service.hpp"
#include "tests/support/bus_peer.hpp"
#include "tests/support/random_geometry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::services {

namespace channels = messages::channels;

/// A keyframe that sees the floor, a wall and the edges between them.
inline egraph::Keyframe keyframe(std::int64_t session, int id) {
  egraph::Keyframe result;
  result.header = {session, 10 * id, 1'000'000 + 100'000 * id};
  result.id = egraph::KeyframeId{id};
  result.world_from_camera = {geometry::so3_exp({0.03 * id, 0.1 * id, -0.02 * id}), {0.1 * id, 0, 0}};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d direction = result.world_from_camera.rotation.transpose() * Eigen::Vector3d::Unit(axis);
    const auto kind = axis < 2 ? egraph::DirectionKind::plane_normal : egraph::DirectionKind::vanishing_direction;
    result.directions.push_back({kind, direction, test::tangential_covariance(direction, 0.005), 50, -1});
    result.plane_distances.push_back(axis < 2 ? 1.0 : std::nan(""));
  }
  if (id > 0) result.covisible = {{egraph::KeyframeId{id - 1}, 30}};
  return result;
}

/// A server on a bus of its own thread, and everybody else on the other end of it.
class EGraphServer : public testing::Test {
 protected:
  explicit EGraphServer(const transport::MemoryNetwork::Disturbance& disturbance = {})
      : network_(std::make_shared<transport::MemoryNetwork>(disturbance)) {
    start();
  }

  /// A new process on the same folder. What was not on the disk is gone, as if it had been killed.
  void restart() {
    service_.reset();
    context_.reset();
    bus_.reset();
    start();
  }

  /// Delivers until nobody has anything to say.
  void settle() {
    while (bus_->handle(std::chrono::milliseconds(0)).value_or(0) + peer_.handle() > 0) {
    }
  }

  void send(const egraph::Keyframe& value) {
    peer_.send(channels::kKeyframe, value);
    settle();
  }

  void ask(std::int64_t session, std::int64_t have_version = 0) {
    peer_.send(channels::kGraphRequest, messages::GraphRequest{session, have_version});
    settle();
  }

  [[nodiscard]] messages::ServiceStatus status() { return context_->status().status(0); }
  [[nodiscard]] std::filesystem::path file(const char* name) const { return folder_.path() / name; }
  [[nodiscard]] bool written(const char* name) const { return std::filesystem::exists(file(name)); }

  /// What a server that is started from now on keeps its journals by.
  void set_store_options(const GraphStoreOptions& options) { store_options_ = options; }

  test::TemporaryFolder folder_;
  std::shared_ptr<transport::MemoryNetwork> network_;
  test::BusPeer peer_{network_};
  test::Inbox<egraph::GraphUpdate> updates_ = peer_.collect<egraph::GraphUpdate>(channels::kGraphUpdate);
  test::Inbox<egraph::GraphSnapshot> snapshots_ = peer_.collect<egraph::GraphSnapshot>(channels::kGraphSnapshot);
  test::Inbox<messages::GraphRequest> restore_requests_ =
      peer_.collect<messages::GraphRequest>(channels::kRestoreRequest);
  std::unique_ptr<transport::MemoryBus> bus_;
  std::unique_ptr<service::ServiceContext> context_;
  std::unique_ptr<EGraphServerService> service_;

 private:
  void start() {
    service::ServiceOptions options;
    options.name = "egraph_server";
    options.out = folder_.path();
    bus_ = std::make_unique<transport::MemoryBus>(network_);
    context_ = std::make_unique<service::ServiceContext>(*bus_, options);
    service_ =
        std::make_unique<EGraphServerService>(*context_, egraph::GraphBuilderOptions{}, folder_.path(), store_options_);
  }

  GraphStoreOptions store_options_;
};

}  // namespace eg::services
