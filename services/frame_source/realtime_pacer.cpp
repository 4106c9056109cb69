#include "services/frame_source/realtime_pacer.hpp"

namespace eg::services {
namespace {

constexpr std::int64_t kLongestWait = 10'000'000;  // microseconds

}  // namespace

std::optional<std::int64_t> RealtimePacer::until(std::int64_t utime, std::int64_t now_utime) {
  if (!waiting_since_) waiting_since_ = now_utime;
  if (!offset_) {
    if (!missing_.empty() && now_utime - *waiting_since_ < kLongestWait) return std::nullopt;
    offset_ = now_utime - utime;
  }
  return utime + *offset_ - now_utime;
}

}  // namespace eg::services
