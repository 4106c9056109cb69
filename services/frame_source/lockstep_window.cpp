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
  if (known == acknowledged_.end() || sequence <= known->second) return;
  known->second = sequence;
  last_progress_ = now_utime;
  patience_ = options_.resend_after;
  while (!in_flight_.empty() && is_done(header_of(in_flight_.front()).sequence)) in_flight_.pop_front();
}

bool LockstepWindow::is_done(std::int64_t sequence) const {
  return std::all_of(acknowledged_.begin(), acknowledged_.end(),
                     [sequence](const auto& consumer) { return consumer.second >= sequence; });
}

const SourceFrame* LockstepWindow::to_resend(std::int64_t now_utime) {
  if (in_flight_.empty() || now_utime - last_progress_ < patience_) return nullptr;
  last_progress_ = now_utime;
  patience_ = std::min(2 * patience_, options_.longest_resend);
  return &in_flight_.front();
}

}  // namespace eg::services
