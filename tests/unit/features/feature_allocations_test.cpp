#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "common/features/feature_extractor.hpp"
#include "common/image/rectifier.hpp"
#include "common/synthetic/sequence.hpp"
#include "tests/unit/features/allocation_counter.hpp"

namespace eg::features {
namespace {

test::Allocations allocations_of_one_frame(FeatureExtractor& extractor, const image::RectifiedFrame& frame) {
  const test::AllocationCounter counter;
  (void)extractor.extract(frame);
  return counter.counted();
}

/// The limits are some 20 % above what there was when this was written. Most of it is OpenCV's: EDLines takes 18 MB
/// and 2700 small pieces per frame, the pyramids of FAST and ORB 2.7 MB.
TEST(FeatureExtractor, TakesLittleFromTheHeapOnceItsBuffersAreThere) {
  synthetic::SequenceOptions options;
  options.noise = synthetic::NoiseOptions{};
  const auto sequence = synthetic::SyntheticSequence::make(options);
  ASSERT_TRUE(sequence);
  const image::RectifiedFrame frame = image::Rectifier().rectify(sequence->frame(40));
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);

  FeatureExtractor extractor;
  const test::Allocations first = allocations_of_one_frame(extractor, frame);
  const test::Allocations second = allocations_of_one_frame(extractor, frame);
  const test::Allocations third = allocations_of_one_frame(extractor, frame);
  EXPECT_LT(second.large_bytes, first.large_bytes) << "buffers are used again";
  EXPECT_EQ(second, third) << "nothing grows from frame to frame";
  EXPECT_LT(third.count, 10000U);
  EXPECT_LT(third.large_count, 28U);
  EXPECT_LT(third.large_bytes, 27'000'000U);
  RecordProperty("allocations", static_cast<int>(third.count));
  RecordProperty("large_allocations", static_cast<int>(third.large_count));
  RecordProperty("large_megabytes", static_cast<int>(third.large_bytes / 1'000'000));
}

}  // namespace
}  // namespace eg::features
