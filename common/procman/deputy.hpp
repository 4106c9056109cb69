#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/procman/host_usage.hpp"
#include "common/procman/now.hpp"
#include "common/procman/output_limit.hpp"
#include "common/procman/protocol.hpp"
#include "common/procman/supervisor.hpp"

namespace eg::procman {

/// Where a deputy's messages go.
struct DeputyOutbox {
  std::function<void(const Info&)> info;
  std::function<void(const Printf&)> printf;
  std::function<void(const Discovery&)> discovery;
};

/// Runs the commands that sheriffs order. At first it asks for a while whether there is a deputy of its name already,
/// and ignores orders. Then it brings its commands into the state that the latest orders describe, and reports at 1 Hz
/// and on every change. Orders are complete: what they do not list is stopped and forgotten.
class Deputy {
 public:
  struct Options {
    std::string name;
    std::int64_t nonce = 0;                ///< tells deputies of one name apart
    std::optional<Configuration> allowed;  ///< only what is in here, too, is run
  };

  Deputy(Options options, DeputyOutbox outbox, Now now);

  void handle(const Orders& orders, Now now);
  void handle(const Info& info, Now now);
  void handle(const Discovery& discovery, Now now);

  /// Does what is due. Waits at most `timeout` for the commands' output.
  void step(Now now, std::chrono::milliseconds timeout);

  /// Asks all commands to stop. Orders count no more.
  void shut_down();
  /// SIGKILL to everything, at once.
  void kill_everything() { supervisor_.kill_everything(); }
  [[nodiscard]] bool busy() const { return supervisor_.busy(); }

  /// Wait status reported of a command that is not allowed: exit status 126, as of a shell that may not run a program.
  static constexpr std::int32_t kRefused = 126 << 8;

  /// There is another deputy of this name.
  struct Conflict {
    int exit_code = 0;  ///< 1: that one is only starting, too; 2: it is at work
    std::string reason;
  };
  [[nodiscard]] const std::optional<Conflict>& conflict() const { return conflict_; }

 private:
  struct Entry {
    OrderedCommand order;
    CommandId id = 0;
    std::int32_t actual_runid = 0;
    bool listed = true;    ///< in the latest orders
    bool refused = false;  ///< ordered to run, but not allowed
    double cpu_usage = 0;  ///< of all processors, in [0, 1]
    ProcessUsage usage;
    OutputLimit output_limit;
    pid_t reported_pid = 0;
  };

  CommandListener make_listener();
  [[nodiscard]] bool discovering(Now now) const { return now.time < discovery_end_; }
  void note_sheriff(const std::string& name, Now now);
  void take_order(const OrderedCommand& order);
  void pursue(Entry& entry);
  void start(Entry& entry);
  void pursue_all();
  [[nodiscard]] bool is_allowed(const CommandDefinition& definition) const;
  [[nodiscard]] pid_t pid_to_report(const Entry& entry) const;
  [[nodiscard]] ReportedCommand report(const Entry& entry) const;
  void send_info(Now now);
  void measure(Now now);
  void send_output(Entry& entry, std::string_view bytes);
  void say(std::int32_t sheriff_id, const std::string& text);
  void say_line(const Entry& entry, const std::string& text);
  Entry* find(CommandId id);

  Options options_;
  DeputyOutbox outbox_;
  std::map<std::int32_t, Entry> entries_;  ///< by sheriff_id
  Now now_;                                ///< of the call that is going on
  Clock::time_point discovery_end_;
  Clock::time_point next_discovery_;
  Clock::time_point next_report_;
  Clock::time_point last_measurement_;
  HostMeter host_meter_;
  HostUsage host_usage_;
  std::string sheriff_;  ///< whose orders came last
  Clock::time_point sheriff_heard_;
  std::string sheriff_before_;  ///< the other whose orders came before that
  Clock::time_point sheriff_before_heard_;
  bool changed_ = false;  ///< since the last report
  bool shutting_down_ = false;
  std::optional<Conflict> conflict_;
  Supervisor supervisor_;  // last: while it ends, its commands still report
};

}  // namespace eg::procman
