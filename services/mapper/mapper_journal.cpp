#include "common/messages/channels.hpp"
#include "services/mapper/map_files.hpp"
#include "services/mapper/mapper_service.hpp"

namespace eg::services {

base::Status MapperService::begin_journal(bool resume) {
  if (context_.options().out.empty()) return {};
  const std::filesystem::path path = context_.options().out / (with_share("mapper", options_.tsdf) + ".journal");
  auto journal =
      resume ? service::MessageJournal::resume(path, [this](const transport::LogEvent& event) { return replay(event); })
             : service::MessageJournal::create(path);
  if (!journal) return tl::make_unexpected(journal.error());
  journal_ = std::move(*journal);
  return {};
}

base::Status MapperService::replay(const transport::LogEvent& event) {
  const auto apply = [&]<typename T>(auto handle) -> base::Status {
    const auto value = messages::decode<T>(event.bytes);
    if (!value) return tl::make_unexpected(value.error());
    handle(*value);
    return {};
  };
  if (event.channel == messages::channels::kRgbd) {
    return apply.operator()<messages::CompressedFrame>([this](const auto& frame) { replayed_ = {frame, {}}; });
  }
  if (event.channel == messages::channels::kFeatures) {
    return apply.operator()<features::FrameFeatures>([this](const auto& features) { replayed_.features = features; });
  }
  if (event.channel == messages::channels::kPose) {
    return apply.operator()<tracking::PoseEstimate>([this](const auto& pose) {
      session_->id = pose.header.session;
      if (replayed_.images) integrate(replayed_, pose);
    });
  }
  if (event.channel == messages::channels::kPoseCorrection) {
    return apply.operator()<tracking::PoseCorrection>([this](const auto& correction) {
      session_->corrections.take(correction);
      session_->map.correct(correction);
    });
  }
  if (event.channel == messages::channels::kAcknowledge) {
    return apply.operator()<messages::Acknowledge>([this](const auto& acknowledge) {
      session_->id = acknowledge.session;
      session_->next_sequence = acknowledge.sequence + 1;
    });
  }
  return base::fail("a journal has no channel " + event.channel);
}

}  // namespace eg::services
