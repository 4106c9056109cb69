#include "services/tracker/tracker_service.hpp"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "common/messages/channels.hpp"

/// What the tracker goes on from when it was killed.
namespace eg::services {

base::Status TrackerService::resume(std::uint64_t most_bytes) {
  most_journal_bytes_ = most_bytes;
  const std::filesystem::path path = context_.options().out / kJournal;
  auto journal =
      service::MessageJournal::resume(path, [this](const transport::LogEvent& event) { return replay(event); });
  if (!journal) return tl::make_unexpected(journal.error());
  journal_ = std::move(*journal);
  return {};
}

base::Status TrackerService::replay(const transport::LogEvent& event) {
  const auto follow = [&]<typename News>() -> base::Status {
    const auto news = messages::decode<News>(event.bytes);
    if (!news) return tl::make_unexpected(news.error());
    auto corrected = session_.tracker.follow(*news);
    if (!corrected) return tl::make_unexpected(corrected.error());
    follow_graph(*std::move(corrected));
    return {};
  };
  if (event.channel == messages::channels::kFeatures) {
    const auto frame = messages::decode<features::FrameFeatures>(event.bytes);
    if (!frame) return tl::make_unexpected(frame.error());
    enter_session(frame->header.session);
    conclude(session_.tracker.track(*frame));
    return {};
  }
  if (event.channel == messages::channels::kPose) {
    const auto refused = messages::decode<tracking::PoseEstimate>(event.bytes);
    if (!refused) return tl::make_unexpected(refused.error());
    enter_session(refused->header.session);
    conclude({*refused, {}, {}});
    return {};
  }
  if (event.channel == messages::channels::kGraphUpdate) return follow.operator()<egraph::GraphUpdate>();
  if (event.channel == messages::channels::kGraphSnapshot) return follow.operator()<egraph::GraphSnapshot>();
  return base::fail("a journal has no channel " + event.channel);
}

void TrackerService::check_journal(const base::Status& written) {
  if (!written) return stop_journal(written.error().message);
  if (journal_->size() > most_journal_bytes_) {
    stop_journal("the journal of " + std::to_string(journal_->size() / 1'000'000) + " MB is larger than it may be");
  }
}

void TrackerService::stop_journal(const std::string& why) {
  spdlog::warn("a tracker that is killed from now on cannot resume: {}", why);
  journal_.reset();
  std::error_code ignored;  // what cannot be written can mostly be removed; if not, the sentence above holds as well
  std::filesystem::remove(context_.options().out / kJournal, ignored);
}

}  // namespace eg::services
