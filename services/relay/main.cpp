#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <string>

#include "common/service/logging.hpp"
#include "common/service/stop_signals.hpp"
#include "common/transport/lcm_bus.hpp"
#include "services/relay/relay.hpp"

namespace {

using namespace eg;

constexpr std::chrono::milliseconds kStep{2};  // on each side: how long a message may wait for the other side

int report(const base::Error& error) {
  spdlog::error(error.message);
  return 1;
}

int run(const transport::LcmBus::Options& own, const transport::LcmBus::Options& shared,
        const relay::Channels& channels) {
  const auto own_bus = transport::LcmBus::create(own);
  if (!own_bus) return report(own_bus.error());
  const auto shared_bus = transport::LcmBus::create(shared);
  if (!shared_bus) return report(shared_bus.error());
  relay::Relay relay(**own_bus, **shared_bus);
  if (const auto started = relay.start(channels); !started) return report(started.error());
  while (!service::stop_requested()) {
    if (const auto step = relay.step(kStep); !step && !service::stop_requested()) return report(step.error());
  }
  for (const auto& [channel, traffic] : relay.traffic()) {
    spdlog::info("{}: {} messages, {} kB", channel, traffic.messages, traffic.bytes / 1000);
  }
  if (relay.lost() > 0) spdlog::warn("{} messages could not be passed on", relay.lost());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  service::log_to_stderr("relay");
  transport::LcmBus::Options own;
  transport::LcmBus::Options shared;
  relay::Channels channels = relay::default_channels();
  CLI::App app(
      "Joins a robot's own LCM bus to a shared one: poses, keyframes and the graph pass, images and features stay",
      "egraph-relay");
  app.add_option("--lcm-url", own.url, "The robot's own bus")->envname("EGRAPH_LCM_URL")->capture_default_str();
  app.add_option("--channel-prefix", own.channel_prefix, "Put before every channel name there")
      ->envname("EGRAPH_CHANNEL_PREFIX");
  app.add_option("--shared-url", shared.url, "The bus that robots, E-Graph server and viewers share")
      ->envname("EGRAPH_SHARED_URL")
      ->required();
  app.add_option("--shared-prefix", shared.channel_prefix, "Put before every channel name there: tells robots apart")
      ->envname("EGRAPH_SHARED_PREFIX");
  app.add_option("--send", channels.out, "Channels that pass from the robot's bus to the shared one")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--fetch", channels.in, "Channels that pass from the shared bus to the robot's")
      ->delimiter(',')
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (own.url == shared.url && own.channel_prefix == shared.channel_prefix) {
    return report({"--shared-url and --shared-prefix are those of the robot's own bus: nothing would be joined"});
  }
  service::catch_stop_signals();
  try {
    return run(own, shared, channels);
  } catch (const std::exception& exception) {
    return report({exception.what()});
  }
}
