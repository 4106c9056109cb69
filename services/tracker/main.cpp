#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "common/io/config.hpp"
#include "services/tracker/tracker_service.hpp"

int main(int argc, char** argv) {
  eg::tracking::TrackerOptions options;
  eg::service::ServiceProgram program;
  program.name = "tracker";
  program.description = "Tracks the camera: rotation from the E-Graph, translation, frame-to-map refinement, keyframes";
  bool resume = false;
  int journal_limit_mb = static_cast<int>(eg::services::kMostJournalBytes / 1'000'000);
  std::string archive;
  program.add_options = [&](CLI::App& app) {
    app.add_option("--load", archive, "Map archive (the --out of an earlier run) to go on in")->envname("EGRAPH_LOAD");
    app.add_flag("--resume", resume, "Keep a journal in --out and go on from the one that a killed tracker left there")
        ->envname("EGRAPH_RESUME");
    app.add_option("--journal-limit", journal_limit_mb, "MB of the journal, beyond which the tracker goes on without")
        ->envname("EGRAPH_JOURNAL_LIMIT")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
  };
  program.configure = [&options](eg::io::ConfigSchema& section) {
    section
        .field("max_translation_sigma", options.max_translation_sigma, {1e-4, 10.0}, "metres; worse is rotation_only")
        .field("max_rotation_sigma", options.max_rotation_sigma, {1e-4, 3.2}, "radians; worse is lost")
        .field("relocalisation_candidates", options.relocalisation_candidates, {1, 1000}, "keyframes per lost frame");
    section.section("parts", "parts of the method to leave out, to see what each is worth")
        .field("egraph", options.parts.egraph, "rotation from the directions of the E-Graph")
        .field("lines", options.parts.lines, "lines and their directions")
        .field("planes", options.parts.planes, "planes and their normals")
        .field("refinement", options.parts.refinement, "refinement of all six unknowns against the map")
        .field("local_bundle_adjustment", options.parts.local_bundle_adjustment, "after every keyframe");
    section.section("bundle", "local bundle adjustment")
        .field("window", options.bundle.window, {1, 100}, "keyframes that may move")
        .field("iterations", options.bundle.iterations, {1, 100}, "at most");
    section.section("keyframes", "when a frame becomes a keyframe")
        .field("max_frames", options.keyframes.max_frames, {1, 10000}, "frames since the last one")
        .field("min_frames", options.keyframes.min_frames, {1, 10000}, "frames between two at least")
        .field("min_tracked_ratio", options.keyframes.min_tracked_ratio, {0.0, 1.0}, "of the last one's features")
        .field("min_tracked_ratio_of_many", options.keyframes.min_tracked_ratio_of_many, {0.0, 1.0}, "of many_features")
        .field("many_features", options.keyframes.many_features, {1, 10000}, "tracked features");
    section.section("search", "where map features are looked for")
        .field("radius", options.search.radius, {1.0, 500.0}, "pixels around the predicted pose")
        .field("refined_radius", options.refined_search_radius, {1.0, 500.0}, "pixels around the first solution")
        .field("max_descriptor_distance", options.search.max_descriptor_distance, {1, 256}, "bits");
    section.section("motion", "how fast the camera may change its speed")
        .field("velocity_change", options.motion.velocity_change, {1e-3, 100.0}, "m/s within a frame")
        .field("angular_velocity_change", options.motion.angular_velocity_change, {1e-3, 100.0},
               "rad/s within a frame");
  };
  program.make = [&](eg::service::ServiceContext& context) -> eg::base::Result<std::unique_ptr<eg::service::Service>> {
    auto tracker = std::make_unique<eg::services::TrackerService>(context, options);
    if (!archive.empty()) {
      if (const auto loaded = tracker->load(archive); !loaded) return tl::make_unexpected(loaded.error());
    }
    if (resume && !context.options().out.empty()) {
      const auto limit = std::uint64_t{1'000'000} * static_cast<std::uint64_t>(journal_limit_mb);
      if (const auto resumed = tracker->resume(limit); !resumed) return tl::make_unexpected(resumed.error());
    }
    return tracker;
  };
  return eg::service::run_service(program, argc, argv);
}
