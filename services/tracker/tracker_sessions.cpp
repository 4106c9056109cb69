#include "services/tracker/tracker_service.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "common/service/map_archive.hpp"
#include "services/tracker/sparse_archive.hpp"

/// How sessions begin and end, and what of them is kept in files.
namespace eg::services {
namespace {

/// After so long (microseconds) without a frame another session may begin.
constexpr std::int64_t kSilence = 2'000'000;
/// Sessions whose late frames are told from those of a new one.
constexpr std::size_t kFormerSessions = 64;

}  // namespace

base::Status TrackerService::load(const std::filesystem::path& archive) {
  auto loaded = load_sparse_archive(service::file_in_archive(archive, service::kSparseMapFile));
  if (!loaded) return tl::make_unexpected(loaded.error());
  session_.record.set_earlier_keyframes(loaded->map.keyframes().size());
  session_.tracker.continue_in(std::move(loaded->map), std::move(loaded->graph));
  return {};
}

bool TrackerService::enter_session(std::int64_t id) {
  if (session_.begun && id == session_.id) return true;
  const bool goes_on = session_.begun && !session_.is_complete() && now_utime_ - session_.heard_utime < kSilence;
  if (goes_on || std::find(former_sessions_.begin(), former_sessions_.end(), id) != former_sessions_.end())
    return false;
  if (session_.begun) {
    leave_session();
    session_ = TrackedSession(id, options_);
  }
  session_.id = id;  // the first one may go on in a map that was loaded
  session_.begun = true;
  return true;
}

void TrackerService::leave_session() {
  former_sessions_.push_back(session_.id);
  if (former_sessions_.size() > kFormerSessions) former_sessions_.pop_front();
  const std::string name = "session-" + std::to_string(session_.id);
  spdlog::info("{} is over after {} frames", name, session_.next_sequence);
  const std::filesystem::path& out = context_.options().out;
  if (!out.empty()) {
    std::error_code failure;
    std::filesystem::create_directories(out / name, failure);
    const auto saved = session_.record.save(out / name, session_.tracker.map());
    if (!saved) spdlog::error("{} could not be saved: {}", name, saved.error().message);
  }
  if (!journal_) return;
  auto begun = service::MessageJournal::create(out / kJournal);
  if (begun) {
    journal_ = std::move(*begun);
  } else {
    stop_journal(begun.error().message);
  }
}

base::Status TrackerService::save() {
  const std::filesystem::path& out = context_.options().out;
  if (out.empty()) return {};
  if (const base::Status saved = session_.record.save(out, session_.tracker.map());
      !saved || session_.tracker.map().empty())
    return saved;
  const std::filesystem::path archive = service::archive_folder(out);
  std::error_code failure;
  std::filesystem::create_directories(archive, failure);
  if (failure) return base::fail(archive.string() + ": cannot be made: " + failure.message());
  return save_sparse_archive(archive / service::kSparseMapFile, session_.tracker.map(), session_.tracker.graph());
}

}  // namespace eg::services
