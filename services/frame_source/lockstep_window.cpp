#include "services/frame_source/lockstep_window.hpp"

#include <algorithm>
#include <utility>

#include "common/base/check.hpp"

namespace eg::services {

LockstepWindow::LockstepWindow(const std::vector<std::string>& consumers, const Options& options)
    : options_(options), patience_(options.resend_after) {
  for (const std::string& consumer : consumers) acknowledged_.emplace(consumer, -1);
}

void LockstepWindow::add(SourceFrame frame, std::int64_t now_utime) {
  EG_CHECK(has_room(), "a lockstep window is never overfilled");
  if (in_flight_.empty()) last_progress_ = now_utime;
  in_flight_.push_back(std::move(frame));
}

void LockstepWindow::acknowledge(const std::string& consumer, std::int64_t sequence, std::int64_t now_utime) {
  const auto known = acknowledged_.find(consumer);
  if (known == acknowledged_.end() || in_flight_.empty()) return;
  // A consumer may know more than this source has sent: from one before it, which was killed. That it is done with what
  // is in flight is all that this says; what comes next needs an acknowledgement of its own.
  sequence = std::min(sequence, header_of(in_flight_.back()).sequence);
  if (sequence <= known->second) return;
  known->second = sequence;
  last_progress_ = now_utime;
  patience_ = options_.resend_after;
  const auto slowest = std::min_element(acknowledged_.begin(), acknowledged_.end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
  while (!in_flight_.empty() && header_of(in_flight_.front()).sequence <= slowest->second) in_flight_.pop_front();
}

const SourceFrame* LockstepWindow::to_resend(std::int64_t now_utime) {
  if (in_flight_.empty() || now_utime - last_progress_ < patience_) return nullptr;
  last_progress_ = now_utime;
  patience_ = std::min(2 * patience_, options_.longest_resend);
  return &in_flight_.front();
}

}  // namespace eg::services
