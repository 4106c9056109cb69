// Time and memory as functions of the graph's size. A building of rooms, each with its own three directions out of
// `kDirections`; the camera walks from room to room and never comes back.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <map>
#include <memory>

#include "common/base/random.hpp"
#include "common/egraph/association.hpp"
#include "common/egraph/graph_builder.hpp"
#include "common/geometry/so3.hpp"

namespace eg::egraph {
namespace {

constexpr int kDirections = 24;  // of the building's walls: a Manhattan world would have 3
constexpr int kKeyframesPerRoom = 50;
constexpr int kSeenPerKeyframe = 8;  // planes and vanishing directions of a room
constexpr double kSigma = 0.005;     // radians

Eigen::Matrix3d tangential(const Eigen::Vector3d& direction) {
  return kSigma * kSigma * (Eigen::Matrix3d::Identity() - direction * direction.transpose());
}

class Building {
 public:
  Building() : random_(1) {
    for (int i = 0; i < kDirections; ++i) {
      const double azimuth = 3.14159 * i / kDirections;
      directions_.emplace_back(std::cos(azimuth), 0.0, std::sin(azimuth));
    }
    directions_.emplace_back(0.0, 1.0, 0.0);  // the floor
  }

  Keyframe keyframe(int id) {
    Keyframe keyframe;
    keyframe.id = KeyframeId{id};
    keyframe.header = {1, id, 100 * id};
    keyframe.world_from_camera = {geometry::so3_exp({0, 0.01 * id, 0}), {0.1 * id, 0, 0}};
    keyframe.covariance = Matrix6d::Identity() * 1e-6;
    const int room = id / kKeyframesPerRoom;
    for (int i = 0; i < kSeenPerKeyframe; ++i) {
      const int wall = i % 3 == 2 ? kDirections : (room * 7 + (i % 3) * kDirections / 2) % kDirections;
      const Eigen::Vector3d& in_world = directions_[static_cast<std::size_t>(wall)];
      const Eigen::Vector3d noise(random_.normal(), random_.normal(), random_.normal());
      const Eigen::Vector3d seen =
          (keyframe.world_from_camera.rotation.transpose() * (in_world + kSigma * noise)).normalized();
      keyframe.directions.push_back({features::DirectionKind::plane_normal, seen, tangential(seen), 1000, -1});
      keyframe.plane_distances.push_back(1.0);
    }
    if (id > 0) {
      keyframe.covisible = {{KeyframeId{id - 1}, 50}};
      keyframe.relative_poses = {{KeyframeId{id - 1},
                                  KeyframeId{id},
                                  {geometry::so3_exp({0, 0.01, 0}), Eigen::Vector3d(0.1, 0, 0)},
                                  Matrix6d::Identity() * 1e-6}};
    }
    return keyframe;
  }

 private:
  base::Random random_;
  std::vector<Eigen::Vector3d> directions_;
};

struct Built {
  Building building;
  GraphBuilder builder;
  double bytes_per_keyframe = 0.0;
  int size = 0;
};

/// The graph of so many keyframes. One grows through all the sizes: they are asked for in increasing order.
Built& built(int keyframes) {
  static auto graph = std::make_unique<Built>();
  if (graph->size > keyframes) graph = std::make_unique<Built>();
  static const std::size_t empty = mallinfo2().uordblks + mallinfo2().hblkhd;
  for (; graph->size < keyframes; ++graph->size) {
    if (!graph->builder.add_keyframe(graph->building.keyframe(graph->size))) std::abort();
  }
  graph->bytes_per_keyframe =
      static_cast<double>(mallinfo2().uordblks + mallinfo2().hblkhd - empty) / static_cast<double>(keyframes);
  return *graph;
}

/// What the tracker asks of its replica for one frame: association and the reference keyframe.
void query_per_frame(benchmark::State& state) {
  Built& graph = built(static_cast<int>(state.range(0)));
  const Keyframe frame = graph.building.keyframe(graph.size);
  const Eigen::Matrix3d uncertainty = 1e-6 * Eigen::Matrix3d::Identity();
  for (auto _ : state) {
    std::vector<LandmarkId> seen;
    for (const Association& association :
         associate(frame.directions, graph.builder.graph(), frame.world_from_camera.rotation, uncertainty)) {
      seen.push_back(association.landmark);
    }
    benchmark::DoNotOptimize(graph.builder.graph().oldest_sharing_keyframe(seen));
  }
  state.counters["landmarks"] = static_cast<double>(graph.builder.graph().landmarks().size());
  state.counters["bytes_per_keyframe"] = graph.bytes_per_keyframe;
}
BENCHMARK(query_per_frame)->RangeMultiplier(10)->Range(100, 1'000'000)->Unit(benchmark::kMicrosecond);

/// What the server does for one keyframe, optimisation included: the mean over 256 keyframes.
void keyframe_in_server(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    Built& graph = built(static_cast<int>(state.range(0)));
    state.ResumeTiming();
    for (int i = 0; i < 256; ++i, ++graph.size) {
      benchmark::DoNotOptimize(graph.builder.add_keyframe(graph.building.keyframe(graph.size)));
    }
  }
  state.SetItemsProcessed(256 * state.iterations());
}
BENCHMARK(keyframe_in_server)->RangeMultiplier(10)->Range(100, 1'000'000)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace eg::egraph
