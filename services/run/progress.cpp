#include "services/run/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace eg::run {
namespace {

constexpr std::chrono::milliseconds kTerminalPeriod{200};
constexpr std::chrono::seconds kPlainPeriod{5};

}  // namespace

Progress::Progress(std::int64_t expected_frames, Clock::time_point now)
    : expected_frames_(expected_frames), first_frame_(now), next_(now), terminal_(isatty(STDOUT_FILENO) == 1) {}

void Progress::show(const RunMonitor& monitor, Clock::time_point now) {
  if (!any_frame_) {
    any_frame_ = monitor.frames_done() > 0;
    first_frame_ = now;
  }
  if (now < next_) return;
  next_ = now + (terminal_ ? Clock::duration(kTerminalPeriod) : Clock::duration(kPlainPeriod));
  clear_line();
  std::printf(terminal_ ? "%s" : "%s\n", text(monitor, now).c_str());
  std::fflush(stdout);
  line_shown_ = terminal_;
}

void Progress::print(const std::string& line) {
  clear_line();
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void Progress::finish(const RunMonitor& monitor, Clock::time_point now) { print(text(monitor, now)); }

std::string Progress::text(const RunMonitor& monitor, Clock::time_point now) const {
  const auto done = static_cast<double>(monitor.frames_done());
  const auto expected = static_cast<double>(std::max<std::int64_t>(expected_frames_ - monitor.frames_skipped(), 1));
  const double elapsed = std::chrono::duration<double>(now - first_frame_).count();
  const double rate = elapsed > 0.0 ? done / elapsed : 0.0;
  const int left = rate > 0.0 ? static_cast<int>((expected - done) / rate + 0.5) : 0;
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(), "frame %.0f/%.0f  %3.0f %%  %5.1f frames/s  %-13s  ETA %d:%02d", done,
                expected, 100.0 * done / expected, rate, monitor.tracking_state().c_str(), left / 60, left % 60);
  return line.data();
}

void Progress::clear_line() {
  if (line_shown_) std::printf("\r\033[K");
  line_shown_ = false;
}

}  // namespace eg::run
