#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdlib>
#include <string>

#include "common/service/logging.hpp"
#include "common/transport/lcm_bus.hpp"
#include "common/transport/lcm_url.hpp"
#include "services/desktop_viewer/live_layers.hpp"
#include "services/desktop_viewer/run_layers.hpp"
#include "services/desktop_viewer/window/window.hpp"

namespace {

using namespace eg;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kStep{20};
constexpr milliseconds kUpdatePeriod{250};  ///< of what is drawn of a running system

struct Arguments {
  services::RunFiles files;
  bool live = false;
  std::string lcm_url = transport::kDefaultLcmUrl;
  std::string channel_prefix;
  std::string picture;
};

int fail(const std::string& why) {
  spdlog::error(why);
  return 1;
}

int show_run(const Arguments& arguments) {
  const auto layers = services::read_run(arguments.files);
  if (!layers) return fail(layers.error().message);
  services::Window window;
  for (const services::Layer& layer : *layers) window.show(layer);
  if (!arguments.picture.empty()) {
    return window.save_picture(arguments.picture) ? 0 : fail("cannot write " + arguments.picture);
  }
  while (!window.is_closed()) window.run_for(kStep);
  return 0;
}

int show_live(const Arguments& arguments) {
  const auto bus = transport::LcmBus::create({arguments.lcm_url, arguments.channel_prefix});
  if (!bus) return fail(bus.error().message);
  service::ServiceOptions options;
  options.name = "desktop_viewer";
  service::ServiceContext context(**bus, options);
  services::LiveLayers layers(context, arguments.files.y_up);
  services::Window window;
  steady_clock::time_point next;
  while (!window.is_closed()) {
    if (const auto handled = (*bus)->handle(kStep); !handled) return fail(handled.error().message);
    const auto now = steady_clock::now();
    layers.idle(std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch()).count());
    if (now >= next) {
      for (const services::Layer& layer : layers.take_changes()) window.show(layer);
      next = now + kUpdatePeriod;
    }
    window.run_for(milliseconds(1));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  service::log_to_stderr("egraph-desktop-viewer");
  Arguments arguments;
  CLI::App app("Shows the results of a run, or a running system, in a window: mesh, map, trajectory, keyframes",
               "egraph-desktop-viewer");
  auto* what = app.add_option_group("what", "what to show")->require_option(1);
  what->add_option("OUT", arguments.files.folder, "What egraph-run --out has written")->check(CLI::ExistingDirectory);
  what->add_flag("--live", arguments.live, "What is on the bus: mesh, trajectory and keyframes as they grow");
  app.add_option("--ground-truth", arguments.files.ground_truth,
                 "True trajectory in TUM format, aligned to OUT's; without it OUT/groundtruth.txt, if it is there");
  app.add_flag("--y-up", arguments.files.y_up, "The camera has a negative fy (ICL-NUIM): its y axis points up");
  app.add_option("--screenshot", arguments.picture, "Write OUT's picture as a PNG file, and end");
  app.add_option("--lcm-url", arguments.lcm_url, "Where the running system meets")->envname("EGRAPH_LCM_URL");
  app.add_option("--channel-prefix", arguments.channel_prefix, "Put before every channel name")
      ->envname("EGRAPH_CHANNEL_PREFIX");
  CLI11_PARSE(app, argc, argv);
  if (const char* display = std::getenv("DISPLAY"); display == nullptr || *display == '\0') {
    return fail("there is no screen: set DISPLAY, or start it with xvfb-run");
  }
  return arguments.live ? show_live(arguments) : show_run(arguments);
}
