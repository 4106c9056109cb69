#include "services/tracker/tracker_service.hpp"

#include "common/messages/channels.hpp"

/// What the tracker says to the others: of itself, again and again, and when it is asked.
namespace eg::services {
namespace {

/// An announced keyframe is announced again after this long (microseconds): a datagram was lost, or the server
/// restarts.
constexpr std::int64_t kAnnouncementPeriod = 300'000;
/// The newest keyframe and the newest correction are announced again and again even so: whoever missed one sees the
/// gap.
constexpr std::int64_t kDigestPeriod = 1'000'000;

}  // namespace

void TrackerService::say(const Answer& news) {
  if (news.keyframe) context_.publish(messages::channels::kKeyframe, *news.keyframe);
  announce(news.corrections);
  if (news.estimate) answer(*news.estimate);
}

void TrackerService::answer(const tracking::PoseEstimate& estimate) {
  context_.publish(messages::channels::kPose, estimate);
  acknowledge(estimate.header.sequence);
}

void TrackerService::acknowledge(std::int64_t sequence) {
  context_.publish(messages::channels::kAcknowledge,
                   messages::Acknowledge{session_.id, sequence, context_.options().name});
}

void TrackerService::announce(const std::vector<tracking::PoseCorrection>& corrections) {
  for (const tracking::PoseCorrection& correction : corrections) {
    context_.publish(messages::channels::kPoseCorrection, correction);
  }
}

void TrackerService::repeat_newest() {
  announce(session_.corrections.since(session_.corrections.version() - 1));
  if (session_.newest_keyframe && !context_.options().lockstep) {
    context_.publish(messages::channels::kKeyframe, *session_.newest_keyframe);
  }
}

void TrackerService::idle(std::int64_t now_utime) {
  now_utime_ = now_utime;
  if (now_utime - last_digest_utime_ >= kDigestPeriod) {
    last_digest_utime_ = now_utime;
    repeat_newest();
  }
  if (session_.unconfirmed.empty()) {
    last_announcement_utime_ = now_utime;
    return;
  }
  if (now_utime - last_announcement_utime_ < kAnnouncementPeriod) return;
  last_announcement_utime_ = now_utime;
  context_.publish(messages::channels::kKeyframe, session_.unconfirmed.front());
}

void TrackerService::on_resend_request(const messages::ResendRequest& request) {
  if (request.session != session_.id || request.numbers.empty()) return;
  if (request.channel == messages::channels::kPose) {
    for (const std::int64_t keyframe : request.numbers) {
      const auto answer = session_.keyframe_answers.find(keyframe);
      if (answer != session_.keyframe_answers.end()) context_.publish(messages::channels::kPose, answer->second);
    }
  } else if (request.channel == messages::channels::kKeyframeFeatures) {
    for (const std::int64_t keyframe : request.numbers) {
      const auto keyframes = session_.tracker.map().keyframes();
      const bool known = keyframe >= 0 && keyframe < static_cast<std::int64_t>(keyframes.size());
      if (known)
        context_.publish(messages::channels::kKeyframeFeatures, keyframes[static_cast<std::size_t>(keyframe)].features);
    }
  } else if (request.channel == messages::channels::kPoseCorrection) {
    announce(session_.corrections.since(request.numbers.front()));
  }
}

void TrackerService::on_restore_request(const messages::GraphRequest& request) {
  if (request.session != session_.id || request.have_version >= session_.tracker.graph().version()) return;
  for (const egraph::GraphSnapshot& part : egraph::split(session_.tracker.graph().snapshot(session_.id))) {
    context_.publish(messages::channels::kRestore, part);
  }
}

}  // namespace eg::services
