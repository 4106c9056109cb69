#include "services/tracker/correction_record.hpp"

#include <algorithm>
#include <utility>

namespace eg::services {

using tracking::PoseCorrection;

std::vector<PoseCorrection> CorrectionRecord::add(std::int64_t session, std::vector<PoseCorrection::Entry> entries) {
  session_ = session;
  const std::int64_t before = version_;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i % entries_per_message_ == 0) ++version_;
    latest_.insert_or_assign(entries[i].keyframe, Latest{version_, entries[i].world_from_camera});
  }
  return since(before);
}

std::vector<PoseCorrection> CorrectionRecord::since(std::int64_t version) const {
  std::map<std::int64_t, std::vector<PoseCorrection::Entry>> by_version;
  for (const auto& [keyframe, latest] : latest_) {
    if (latest.version > version) by_version[latest.version].push_back({keyframe, latest.world_from_camera});
  }
  std::vector<PoseCorrection> corrections;
  for (auto& [latest_version, entries] : by_version) {
    if (corrections.empty() || corrections.back().entries.size() + entries.size() > entries_per_message_) {
      const std::int64_t since = corrections.empty() ? version : corrections.back().version;
      corrections.push_back({session_, latest_version, {}, since});
    }
    PoseCorrection& correction = corrections.back();
    correction.version = latest_version;
    correction.entries.insert(correction.entries.end(), entries.begin(), entries.end());
  }
  return corrections;
}

}  // namespace eg::services
