#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/random.hpp"
#include "common/procman/command_set.hpp"
#include "common/procman/now.hpp"
#include "common/procman/protocol.hpp"

namespace eg::procman {

/// In libbot2's words.
enum class CommandStatus {
  unknown,  ///< its deputy has not been heard of, or not for long
  starting,
  running,
  restarting,
  stopping,
  removing,  ///< not this sheriff's: its deputy is about to forget it
  stopped_ok,
  stopped_error,
};
const char* to_string(CommandStatus status);

/// Says what deputies are to run: the commands of a configuration, numbered as there. What a deputy already runs when
/// it is first heard of is taken over as it is, if the configuration defines it in the same words; its other commands
/// end, for orders are complete. Deputies that the configuration does not name are left alone.
class Sheriff : public CommandSet {
 public:
  struct Options {
    std::string name;        ///< host:pid:utime
    std::uint64_t seed = 0;  ///< of the commands' numbers, which must differ from those of other sheriffs
  };

  /// `configuration` must outlive the sheriff.
  Sheriff(const Configuration& configuration, const Options& options, Now now);

  void start(std::size_t command) override;
  void stop(std::size_t command) override;
  void restart(std::size_t command) override;
  [[nodiscard]] Condition condition(std::size_t command) const override;

  void handle(const Info& info, Now now);
  void handle(const Orders& orders, Now now);

  /// The orders that are due, to every deputy of the configuration that has been heard of: at 1 Hz, and at once on a
  /// change. None for a while at first: it listens whether there is another sheriff.
  std::vector<Orders> take_orders(Now now);

  /// Another sheriff orders the same deputies: one that was there before, so that this one must end; empty: none.
  [[nodiscard]] const std::string& superior() const { return superior_; }
  /// One that came later and should have ended; empty: none.
  [[nodiscard]] const std::string& intruder() const { return intruder_; }

  /// A deputy that has not been heard of for 30 s is taken for dead.
  [[nodiscard]] bool is_stale(const std::string& host, Now now) const;

  [[nodiscard]] CommandStatus status(std::size_t command, Now now) const;
  /// What the command's deputy last reported of it; null: nothing.
  [[nodiscard]] const ReportedCommand* report(std::size_t command) const;
  /// The index of the command with this number; the number of commands: it is none of this sheriff's.
  [[nodiscard]] std::size_t find(std::int32_t sheriff_id) const;

  struct DeputyState {
    Info info;
    Clock::time_point heard;
  };
  /// All that the configuration names and that were heard of, and some others.
  [[nodiscard]] const std::map<std::string, DeputyState>& deputies() const { return deputies_; }

  /// The deputy that is to run a command: "localhost" if it names none.
  static std::string host_of(const Command& command);

 private:
  /// What is wanted of a command whose deputy has not been heard of.
  enum class Wish { none, start, stop, restart };

  void wish(std::size_t command, Wish wish);
  [[nodiscard]] bool names_host(const std::string& host) const;
  void take_over(const Info& info);
  void notice_new_deputy(const DeputyState& before, const Info& info);
  [[nodiscard]] Orders make_orders(const std::string& host, Now now) const;

  const Configuration& configuration_;
  std::string name_;
  std::vector<OrderedCommand> orders_;  ///< as the configuration's commands
  std::vector<Wish> wishes_;
  std::map<std::string, DeputyState> deputies_;
  Clock::time_point listens_until_;
  Clock::time_point next_orders_;
  Now now_;  ///< of the last call
  bool changed_ = false;
  std::string superior_;
  std::string intruder_;
};

}  // namespace eg::procman
