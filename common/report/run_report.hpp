#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/egraph/types.hpp"
#include "common/eval/render.hpp"
#include "common/eval/trajectory_errors.hpp"
#include "common/report/plots.hpp"

namespace eg::report {

/// One service over a whole run.
struct ServiceSummary {
  std::string name;
  std::int64_t frames = 0;
  std::int64_t dropped = 0;
  std::int64_t rejected = 0;
  double latency_p50_ms = 0.0, latency_p90_ms = 0.0, latency_p99_ms = 0.0, latency_max_ms = 0.0;
  double cpu_seconds = 0.0;
  std::int64_t peak_memory_bytes = 0;
};

/// A picture of the mesh.
struct Picture {
  std::vector<std::uint8_t> png;
  std::string caption;
};

/// All that is known of a run; each part may be empty.
struct RunResults {
  std::string input;
  std::string mode;     ///< "lockstep" or "realtime"
  std::string outcome;  ///< "complete", "interrupted", or "failed" and why
  std::int64_t frames = 0;
  std::int64_t frames_with_pose = 0;
  std::int64_t keyframes = 0;
  double wall_seconds = 0.0;
  std::vector<geometry::StampedPose> estimate;
  std::vector<geometry::StampedPose> truth;  ///< in its own frame
  std::vector<StateSample> states;
  egraph::GraphWithEdges graph;
  std::vector<Picture> mesh_views;
  std::vector<ServiceSummary> services;
  std::string settings;      ///< the configuration, as text
  eval::RenderOptions view;  ///< which way is up
};

/// The run as one page that needs nothing else: trajectory in three views against the truth, errors over time, states,
/// E-Graph beside covisibility graph, mesh, time per service, settings.
std::string write_report(const RunResults& run);

}  // namespace eg::report
