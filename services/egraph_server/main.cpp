#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "common/io/config.hpp"
#include "services/egraph_server/egraph_server_service.hpp"

using eg::egraph::Refinement;

int main(int argc, char** argv) {
  eg::egraph::GraphBuilderOptions options;
  std::filesystem::path state;
  eg::services::GraphStoreOptions store;
  int compaction_kb = static_cast<int>(store.compaction_bytes / 1024);
  eg::service::ServiceProgram program;
  program.name = "egraph_server";
  program.description = "Keeps the extensibility graph: associates and fuses the scene directions of every keyframe";
  program.configure = [&options, &compaction_kb](eg::io::ConfigSchema& section) {
    section.field("max_angle", options.association.max_angle, {0.001, 0.5}, "radians, th_vd of the paper")
        .field("max_chi2", options.association.max_chi2, {0.1, 1000.0}, "gate on the covariance-weighted difference")
        .field("potential_lifetime", options.potential_lifetime, {1, 10000}, "keyframes a single direction is kept")
        .field("min_landmark_sigma", options.min_landmark_sigma, {0.0, 0.1}, "radians")
        .choice("refinement", options.optimizer.refine,
                {{"none", Refinement::none}, {"rotations", Refinement::rotations}, {"poses", Refinement::poses}},
                "what is optimised over the whole graph: nothing, rotations, or positions too")
        .field("compaction_kb", compaction_kb, {1, 1'000'000},
               "kB of a journal, beyond which it is rewritten as a snapshot if it has grown fourfold");
  };
  program.add_options = [&state, &program](CLI::App& app) {
    app.add_option("--robots", program.robots,
                   "Channel prefixes of several robots to serve at once, separated by commas; each has a folder of its "
                   "own in --out and --state")
        ->envname("EGRAPH_ROBOTS")
        ->delimiter(',');
    app.add_option("--state", state, "Folder that keeps the graphs, so that a restarted server goes on; else --out")
        ->envname("EGRAPH_STATE");
  };
  program.make = [&](eg::service::ServiceContext& context) -> eg::base::Result<std::unique_ptr<eg::service::Service>> {
    const eg::service::ServiceOptions& of_service = context.options();
    const auto folder = state.empty() ? of_service.out : of_service.robot.empty() ? state : state / of_service.robot;
    if (const auto usable = eg::services::GraphStore::prepare_folder(folder); !usable) {
      return tl::make_unexpected(usable.error());
    }
    store.compaction_bytes = std::size_t{1024} * static_cast<std::size_t>(compaction_kb);
    return std::make_unique<eg::services::EGraphServerService>(context, options, folder, store);
  };
  return eg::service::run_service(program, argc, argv);
}
