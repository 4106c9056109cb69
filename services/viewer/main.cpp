#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "common/service/service.hpp"
#include "services/viewer/viewer_service.hpp"

namespace {

/// The page lies beside the programs' folder.
std::filesystem::path installed_page() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "viewer";
}

}  // namespace

int main(int argc, char** argv) {
  eg::services::ViewerOptions options;
  options.page = installed_page();
  eg::service::ServiceProgram program;
  program.name = "viewer";
  program.description = "Shows the running system in web browsers";
  program.add_options = [&](CLI::App& app) {
    app.add_option("--http", options.web.address,
                   "Address and port to serve browsers at; the default is this machine only")
        ->envname("EGRAPH_HTTP")
        ->capture_default_str();
    app.add_option("--ground-truth", options.ground_truth, "True trajectory in TUM format, shown beside the estimate")
        ->envname("EGRAPH_GROUND_TRUTH");
  };
  program.configure = [&](eg::io::ConfigSchema& section) {
    section.field("scene_budget", options.scene_budget, {16, 100'000}, "MB of scene kept for browsers")
        .field("image_budget", options.image_budget, {0, 100'000}, "MB of keyframe images kept for browsers")
        .field("max_connections", options.web.max_connections, {1, 1000}, "browsers and requests at the same time");
  };
  program.make = [&](eg::service::ServiceContext& context) -> eg::base::Result<std::unique_ptr<eg::service::Service>> {
    auto service = eg::services::ViewerService::make(context, options);
    if (!service) return tl::make_unexpected(service.error());
    spdlog::info("open {} in a browser", (*service)->url());
    return std::unique_ptr<eg::service::Service>(std::move(*service));
  };
  return eg::service::run_service(program, argc, argv);
}
