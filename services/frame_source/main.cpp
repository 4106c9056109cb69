#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "common/io/camera_file.hpp"
#include "common/io/config.hpp"
#include "services/frame_source/frame_source_service.hpp"
#include "services/frame_source/live_source_service.hpp"
#include "services/frame_source/openni/openni_camera.hpp"

namespace {

using namespace eg;

/// Where images come from that are no recording.
struct LiveOptions {
  std::string channel;
  std::string openni;
};

void add_options(CLI::App& app, services::FrameSourceOptions& options, LiveOptions& live) {
  auto* const channel =
      app.add_option("--live", live.channel,
                     "Channel of a live camera (bot_core.images_t, e.g. OPENNI_FRAME) instead of a data set")
          ->envname("EGRAPH_LIVE");
  app.add_option("--openni", live.openni, "Camera at this machine, through OpenNI2: 'any', or its URI")
      ->envname("EGRAPH_OPENNI")
      ->excludes(channel);
  app.add_option("--dataset", options.input.dataset,
                 "Folder in TUM RGB-D or ICL-NUIM layout, synthetic:SCENE or log:FILE")
      ->envname("EGRAPH_DATASET")
      ->capture_default_str();
  app.add_option("--observations", options.input.observations,
                 "Feature-level data instead of --dataset: folder in the format of Open-Structure, or synthetic:walk")
      ->envname("EGRAPH_OBSERVATIONS");
  app.add_option("--camera", options.input.camera, "Camera by name or YAML file; without it found from the data set")
      ->envname("EGRAPH_CAMERA");
  app.add_option("--depth-noise", options.input.depth_noise,
                 "Add the noise of a structured-light camera to the data set's depth, with this seed; 0: none")
      ->envname("EGRAPH_DEPTH_NOISE")
      ->check(CLI::Range(std::int64_t{0}, INT64_MAX));
  app.add_option("--frames", options.input.max_frames, "Read at most this many frames; 0: all")
      ->envname("EGRAPH_FRAMES")
      ->check(CLI::Range(std::int64_t{0}, INT64_MAX));
  app.add_option("--consumers", options.consumers, "Services that acknowledge every frame")
      ->envname("EGRAPH_CONSUMERS")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--session", options.input.session,
                 "Number of this recording or robot, carried by every message (1); which of a log's sessions to replay")
      ->envname("EGRAPH_SESSION");
  app.add_option("--log-channel", options.input.log_channel, "Channel of a log's frames if there are several")
      ->envname("EGRAPH_LOG_CHANNEL");
}

void configure(io::ConfigSchema& section, services::FrameSourceOptions& options) {
  section.section("synthetic", "what is made up: the built-in scenes, the depth of observations")
      .field("seed", options.input.seed, {0, 1e15}, "of textures and noise, also of the depth of observations")
      .field("noise", options.input.noise, "of a structured-light depth camera and its colour camera");
}

base::Result<std::unique_ptr<service::Service>> make_live(service::ServiceContext& context, const LiveOptions& live,
                                                          const services::InputOptions& input) {
  const std::string option = live.openni.empty() ? "--live" : "--openni";
  if (context.options().lockstep) return base::fail(option + ": a camera waits for nobody, so not with --lockstep");
  if (input.camera.empty()) {
    return base::fail(option + " needs --camera: the images do not say which camera took them");
  }
  auto camera = io::read_camera(input.camera);
  if (!camera) return tl::make_unexpected(camera.error());
  std::unique_ptr<services::CameraDevice> device;
  if (!live.openni.empty()) {
    auto opened = services::open_openni_camera(live.openni, *camera);
    if (!opened) return tl::make_unexpected(opened.error());
    device = *std::move(opened);
    spdlog::info("{}", device->description());
  }
  services::LiveSourceOptions options{device ? "camera" : live.channel, *std::move(camera), input.session.value_or(1)};
  return std::make_unique<services::LiveSourceService>(context, std::move(options), std::move(device));
}

base::Result<std::unique_ptr<service::Service>> make(service::ServiceContext& context,
                                                     const services::FrameSourceOptions& options) {
  if (const auto valid = services::validate(options, context.options().lockstep); !valid) {
    return tl::make_unexpected(valid.error());
  }
  auto input = services::open_input(options.input);
  if (!input) return tl::make_unexpected(input.error());
  return std::make_unique<services::FrameSourceService>(context, options, *std::move(input));
}

}  // namespace

int main(int argc, char** argv) {
  services::FrameSourceOptions options;
  service::ServiceProgram program;
  program.name = "frame_source";
  program.description = "Publishes the frames of a recording or of a synthetic scene";
  LiveOptions live;
  program.add_options = [&](CLI::App& app) { add_options(app, options, live); };
  program.configure = [&options](io::ConfigSchema& section) { configure(section, options); };
  program.make = [&](service::ServiceContext& context) {
    const bool recorded = live.channel.empty() && live.openni.empty();
    return recorded ? make(context, options) : make_live(context, live, options.input);
  };
  return service::run_service(program, argc, argv);
}
