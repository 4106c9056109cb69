#include "services/feature_extractor/feature_extractor_service.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <string>

#include "common/messages/channels.hpp"

namespace eg::feature_extractor {
namespace {

constexpr int kRealtimeQueue = 2;   // what waits longer is out of date
constexpr int kLockstepQueue = 16;  // more than the source sends ahead, with repetitions
constexpr std::size_t kMaxAnswers = 16;

}  // namespace

FeatureExtractorService::FeatureExtractorService(service::ServiceContext& context,
                                                 const features::FeatureExtractorOptions& options)
    : context_(context), extractor_(options) {
  context_.subscribe<image::RgbdFrame>(
      messages::channels::kRgbd, context_.options().lockstep ? kLockstepQueue : kRealtimeQueue,
      [this](const image::RgbdFrame& frame) { handle_frame(frame); },
      [this](messages::ByteView bytes, const std::string&) { handle_refused(bytes); });
}

void FeatureExtractorService::handle_refused(messages::ByteView bytes) {
  const auto frame = messages::decode<messages::CompressedFrame>(bytes);
  if (!frame) return;
  features::FrameFeatures nothing;
  nothing.header = frame->header;
  nothing.camera = frame->camera;
  nothing.camera.distortion = {};
  context_.publish(messages::channels::kFeatures, nothing);
}

void FeatureExtractorService::handle_frame(const image::RgbdFrame& frame) {
  if (const features::FrameFeatures* answer = find_answer(frame.header)) {
    context_.publish(messages::channels::kFeatures, *answer);
    return;
  }
  if (is_out_of_date(frame.header)) return;
  const auto start = std::chrono::steady_clock::now();
  answers_.push_back(extractor_.extract(rectifier_.rectify(frame)));
  if (answers_.size() > kMaxAnswers) answers_.pop_front();
  context_.publish(messages::channels::kFeatures, answers_.back());

  const auto latency = std::chrono::steady_clock::now() - start;
  // In lockstep what is missing comes again.
  if (!context_.options().lockstep) context_.status().count_sequence(frame.header.session, frame.header.sequence);
  context_.status().count_frame(std::chrono::duration<double, std::milli>(latency).count());
}

bool FeatureExtractorService::is_out_of_date(const image::FrameHeader& header) const {
  if (context_.options().lockstep || answers_.empty()) return false;
  const image::FrameHeader& newest = answers_.back().header;
  return header.session == newest.session && header.sequence < newest.sequence;
}

const features::FrameFeatures* FeatureExtractorService::find_answer(const image::FrameHeader& header) const {
  const auto answer = std::find_if(answers_.begin(), answers_.end(), [&](const features::FrameFeatures& features) {
    return features.header.session == header.session && features.header.sequence == header.sequence;
  });
  return answer == answers_.end() ? nullptr : &*answer;
}

}  // namespace eg::feature_extractor
