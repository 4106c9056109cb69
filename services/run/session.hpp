#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/service/service.hpp"
#include "services/run/input.hpp"
#include "services/run/progress.hpp"
#include "services/run/run_monitor.hpp"
#include "services/run/run_options.hpp"
#include "services/run/save_request.hpp"
#include "services/run/sheriff_process.hpp"

namespace eg::run {

/// How often the user has asked to stop so far.
using StopCount = std::function<int()>;

/// One run from when the services are being started: follows it to its end, has the results saved, stops the services.
class Session {
 public:
  /// `bus` and `sheriff` must outlive the session.
  Session(const RunOptions& options, const Input& input, transport::Bus& bus, SheriffProcess& sheriff, StopCount stops);

  /// Returns when all frames are done, or on a failure or an interruption; then nothing runs any more.
  void run();

  [[nodiscard]] const RunMonitor& monitor() const { return monitor_; }
  /// Why the run failed, one sentence; empty: it did not.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  [[nodiscard]] bool interrupted() const { return stops_() > expected_stops_; }
  /// From the first to the last frame, seconds.
  [[nodiscard]] double processing_seconds() const;
  /// For how long only the page was kept, seconds.
  [[nodiscard]] double viewing_seconds() const { return std::chrono::duration<double>(viewing_).count(); }

 private:
  void process_frames();
  void save();
  /// Until the user has seen enough.
  void keep_view();
  void stop();
  /// One round of messages and output.
  void step();
  void handle_line(const std::string& line);
  void show_page_address(std::string_view line);
  /// Keeps what a service complains of, to be told if it ends.
  void note_error(const std::string& line);
  /// The processes that have results and are alive.
  [[nodiscard]] std::set<std::string> savers() const;
  /// A service has died; procman would start it again. Whether that is of no use.
  bool has_given_up(const std::string& name, std::string_view how);
  void fail(const std::string& why);

  SheriffProcess& sheriff_;
  transport::Bus& bus_;
  StopCount stops_;
  int expected_stops_ = 0;  ///< that were asked for and are no interruption
  service::ServiceContext context_;
  RunMonitor monitor_;
  SaveRequest save_request_;
  Progress progress_;
  std::set<std::string> savers_;  ///< services that have results
  std::set<std::string> ended_;   ///< processes that will not come back
  bool keep_view_;
  std::string view_url_;  ///< where the viewer says it is
  bool frames_running_ = true;
  std::set<std::string> warnings_;                  ///< that were shown: what ends and comes back says the same again
  std::map<std::string, std::string> last_errors_;  ///< of services, without the service's name
  std::map<std::string, int> deaths_;               ///< of services, since a frame was finished
  std::int64_t done_at_last_death_ = 0;
  std::string failure_;
  Clock::duration viewing_{};
  Clock::time_point first_frame_;
  Clock::time_point last_frame_;
};

}  // namespace eg::run
