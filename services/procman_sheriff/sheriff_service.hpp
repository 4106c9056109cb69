#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/procman/line_splitter.hpp"
#include "common/procman/script_runner.hpp"
#include "common/procman/sheriff.hpp"
#include "common/transport/bus.hpp"
#include "services/procman_sheriff/console.hpp"

namespace eg::procman_sheriff {

/// What a sheriff does when its script is done.
enum class OnScriptComplete {
  stay,     ///< goes on ordering, so that a deputy that is started anew gets its commands back
  exit,     ///< ends; the deputies keep what they run
  observe,  ///< orders no more, but still shows
};

struct SheriffOptions {
  std::string script;                           ///< empty: start everything
  std::chrono::milliseconds wait_limit{30000};  ///< for each wait of the script
  OnScriptComplete on_script_complete = OnScriptComplete::stay;
  bool observe = false;  ///< from the beginning; no script
};

/// A sheriff on a bus. It shows what the commands print and what becomes of them.
class SheriffService {
 public:
  /// `configuration` must outlive the service; the script must have passed check_script().
  SheriffService(transport::Bus& bus, const procman::Configuration& configuration, const SheriffOptions& options);

  base::Status subscribe();

  /// Runs until the script is done, if that is to be the end, or until `stop` says so. An error: the script failed, or
  /// there is another sheriff. The commands go on in any case.
  base::Status run(const std::function<bool()>& stop);

 private:
  base::Status step();
  base::Status carry_script_on();
  void send_orders();
  void show();
  void note_changes();
  void print_output(const procman::Printf& text);
  void warn_of_intruder();
  template <typename Message>
  base::Status subscribe(const char* channel, std::function<void(const Message&)> handler);
  template <typename Message>
  void publish(const char* channel, const Message& message);

  transport::Bus& bus_;
  const procman::Configuration& configuration_;
  SheriffOptions options_;
  procman::Now now_;
  procman::Sheriff sheriff_;
  std::optional<procman::ScriptRunner> script_;
  Console console_;
  std::map<std::int32_t, procman::LineSplitter> output_;  ///< by sheriff_id; of deputies themselves at 0
  std::vector<procman::CommandStatus> shown_;             ///< by command, what was last said of it
  procman::Clock::time_point next_show_;
  bool observing_;
  std::string intruder_warned_of_;
};

}  // namespace eg::procman_sheriff
