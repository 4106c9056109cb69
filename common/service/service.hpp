#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.hpp"
#include "common/io/config.hpp"
#include "common/messages/codec.hpp"
#include "common/service/status_reporter.hpp"
#include "common/transport/bus.hpp"

namespace CLI {
class App;
}

namespace eg::service {

/// What every service has on its command line (or in the environment, as EGRAPH_LCM_URL, EGRAPH_CHANNEL_PREFIX,
/// EGRAPH_CONFIG, EGRAPH_OUT, EGRAPH_LOCKSTEP=1), so that procman files need to name nothing but the programs.
struct ServiceOptions {
  std::string name;                   ///< of the service, e.g. "tracker"
  std::string lcm_url;                ///< --lcm-url
  std::string channel_prefix;         ///< --channel-prefix
  std::filesystem::path config_file;  ///< --config; empty: the defaults
  std::filesystem::path out;          ///< --out, an existing folder; empty: save nothing
  bool lockstep = false;              ///< --lockstep
  std::string robot = {};             ///< prefix of the one of several robots that this is for; comes behind the other
};

/// How many messages may wait while a service is busy; what comes then is dropped, so that a slow service costs neither
/// memory nor ever staler results. State is asked for again, and small messages are repeated or of the newest alone.
inline constexpr int kStateQueue = 256;
inline constexpr int kSmallQueue = 1024;

/// What a service is given to work with: typed publish and subscribe, options and status.
class ServiceContext {
 public:
  ServiceContext(transport::Bus& bus, ServiceOptions options);

  [[nodiscard]] const ServiceOptions& options() const { return options_; }
  /// The name under which it reports, answers requests and acknowledges from now on, if several share its work.
  void rename(const std::string& name);
  StatusReporter& status() { return status_; }

  /// Encodes and sends. A failure is counted in the status and logged.
  template <typename T>
  void publish(const char* channel, const T& value) {
    publish_bytes(channel, messages::encode(value));
  }

  /// What hears of a message that was refused: its bytes, and one sentence with the channel and the field.
  using RefusalHandler = std::function<void(messages::ByteView bytes, const std::string& why)>;

  /// Decodes and validates before `handler` sees a message; what fails is counted and reported, never fatal, and given
  /// to `refused`, if there is one.
  template <typename T>
  void subscribe(const char* channel, int queue_capacity, std::function<void(const T&)> handler,
                 RefusalHandler refused = {}) {
    const auto on_bytes = [this, channel, handler = std::move(handler),
                           refused = std::move(refused)](messages::ByteView bytes) {
      const auto value = messages::decode<T>(bytes);
      if (value) return handler(*value);
      const std::string why = std::string(channel) + ": " + value.error().message;
      status_.count_rejected(why);
      if (refused) refused(bytes, why);
    };
    subscribe_bytes(channel, queue_capacity, on_bytes);
  }

 private:
  void publish_bytes(const char* channel, const messages::Bytes& bytes);
  void subscribe_bytes(const char* channel, int queue_capacity, std::function<void(messages::ByteView)> handler);

  transport::Bus& bus_;
  ServiceOptions options_;
  StatusReporter status_;
};

/// A service subscribes in its constructor and then only reacts. It runs in one thread.
class Service {
 public:
  virtual ~Service() = default;

  /// Called after every round of messages and at least every 20 ms: timers, resends. `now_utime`: monotonic,
  /// microseconds.
  virtual void idle(std::int64_t /*now_utime*/) {}

  /// Writes results into options().out, whole or not at all. Called on Control::save and once before the process ends.
  virtual base::Status save() { return {}; }

  /// True when there is nothing left to do: the process then saves and ends.
  [[nodiscard]] virtual bool finished() const { return false; }
};

/// What a service's main() hands to run_service().
struct ServiceProgram {
  std::string name;         ///< "tracker"; the program is egraph-<name with dashes>
  std::string description;  ///< first line of --help

  /// Makes the service and its subscriptions. It reads options().config_file itself: strictly, an unknown key is an
  /// error.
  std::function<base::Result<std::unique_ptr<Service>>(ServiceContext&)> make;

  /// Optional: adds options of the service's own to the command line (CLI/CLI.hpp; give each an envname).
  std::function<void(CLI::App&)> add_options;

  /// Channel prefixes of several robots that one process serves, each by a service of its own (ServiceGroup); an option
  /// of add_options may set them. Empty: one service, for whoever has --channel-prefix.
  std::vector<std::string> robots;

  /// Optional: the keys of the service's section in the configuration file. They refer to variables that outlive
  /// run_service(), such as main()'s own. One file may hold a section for every service; each reads only its own.
  std::function<void(io::ConfigSchema& section)> configure;
};

/// The main() of a service: command line, signals (SIGINT, SIGTERM, SIGHUP: save and end with 0), bus, message loop,
/// Control, 1 Hz status. Returns the exit code; what went wrong is one line on stderr.
int run_service(const ServiceProgram& program, int argc, const char* const* argv);

}  // namespace eg::service
