#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "services/run/run_monitor.hpp"

namespace eg::run {

/// Progress for a person: one line that is rewritten on a terminal, a line every few seconds elsewhere.
class Progress {
 public:
  Progress(std::int64_t expected_frames, Clock::time_point now);

  void show(const RunMonitor& monitor, Clock::time_point now);
  /// A line for the record, above the progress line.
  void print(const std::string& line);
  /// Ends the progress line.
  void finish(const RunMonitor& monitor, Clock::time_point now);

 private:
  [[nodiscard]] std::string text(const RunMonitor& monitor, Clock::time_point now) const;
  void clear_line();

  std::int64_t expected_frames_;
  Clock::time_point first_frame_;
  Clock::time_point next_;
  bool any_frame_ = false;
  bool terminal_;
  bool line_shown_ = false;
};

}  // namespace eg::run
