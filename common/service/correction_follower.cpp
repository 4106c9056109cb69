#include "common/service/correction_follower.hpp"

#include <algorithm>

namespace eg::service {
namespace {

constexpr std::int64_t kPeriod = 200'000;  // microseconds between two requests; a message that was overtaken is sooner

}  // namespace

bool CorrectionFollower::take(const tracking::PoseCorrection& correction) {
  announce(correction.version);
  if (correction.version <= complete_) return false;
  if (correction.since <= complete_) complete_ = correction.version;
  return true;
}

void CorrectionFollower::announce(std::int64_t version) { announced_ = std::max(announced_, version); }

std::optional<std::int64_t> CorrectionFollower::to_request(std::int64_t now_utime) {
  if (complete_ >= announced_) last_request_ = now_utime;  // what is announced next has a period to come by itself
  if (now_utime - last_request_ < kPeriod) return std::nullopt;
  last_request_ = now_utime;
  return complete_;
}

}  // namespace eg::service
