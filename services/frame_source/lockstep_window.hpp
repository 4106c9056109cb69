#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "services/frame_source/source_frame.hpp"

namespace eg::services {

/// The frames that were sent and are not yet acknowledged by every consumer: at most a few, so that no queue on the way
/// overflows, and kept, so that a frame that was lost can be sent again.
class LockstepWindow {
 public:
  struct Options {
    std::size_t frames = 3;                   ///< in flight at most
    std::int64_t resend_after = 500'000;      ///< microseconds without an acknowledgement
    std::int64_t longest_resend = 2'000'000;  ///< the wait doubles up to this while nobody answers
  };

  LockstepWindow(const std::vector<std::string>& consumers, const Options& options);

  [[nodiscard]] bool has_room() const { return in_flight_.size() < options_.frames; }
  [[nodiscard]] bool empty() const { return in_flight_.empty(); }

  void add(SourceFrame frame, std::int64_t now_utime);

  /// `consumer` is done with `sequence` and everything before. Unknown consumers do not count.
  void acknowledge(const std::string& consumer, std::int64_t sequence, std::int64_t now_utime);

  /// Whether all consumers are done with `sequence`. They may be further than what was added: a source before this one
  /// was killed.
  [[nodiscard]] bool is_done(std::int64_t sequence) const;

  /// The oldest frame in flight, if it is time to send it again; null otherwise.
  [[nodiscard]] const SourceFrame* to_resend(std::int64_t now_utime);

 private:
  Options options_;
  std::map<std::string, std::int64_t> acknowledged_;  ///< by consumer, the newest sequence; -1: none
  std::deque<SourceFrame> in_flight_;
  std::int64_t last_progress_ = 0;
  std::int64_t patience_;
};

}  // namespace eg::services
