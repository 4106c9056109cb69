#pragma once

#include <deque>

#include "common/features/feature_extractor.hpp"
#include "common/image/rectifier.hpp"
#include "common/service/service.hpp"

namespace eg::feature_extractor {

/// Turns every RGBD message into a FEATURES message. Frames do not depend on each other, so several of these can run
/// side by side. A frame that comes again (in lockstep the source sends again what was not acknowledged) is answered
/// again, without computing it again.
class FeatureExtractorService : public service::Service {
 public:
  /// `options` must be valid.
  FeatureExtractorService(service::ServiceContext& context, const features::FeatureExtractorOptions& options);

 private:
  void handle_frame(const image::RgbdFrame& frame);
  /// Images that cannot be decoded are a frame without features: lockstep would wait for their frame for ever.
  void handle_refused(messages::ByteView bytes);
  /// In real time: one that is sent again for the mapper, or was overtaken; the tracker is past it.
  [[nodiscard]] bool is_out_of_date(const image::FrameHeader& header) const;
  [[nodiscard]] const features::FrameFeatures* find_answer(const image::FrameHeader& header) const;

  service::ServiceContext& context_;
  image::Rectifier rectifier_;
  features::FeatureExtractor extractor_;
  std::deque<features::FrameFeatures> answers_;  ///< of the latest frames, the newest last
};

}  // namespace eg::feature_extractor
