#include "common/service/status_reporter.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "common/base/random.hpp"

namespace eg::service {
namespace {

TEST(LatencyHistogram, FindsPercentilesWithinTwoPercent) {
  LatencyHistogram histogram;
  for (int i = 1; i <= 1000; ++i) histogram.add(0.1 * i);
  EXPECT_NEAR(histogram.percentile_ms(0.5), 50.0, 1.0);
  EXPECT_NEAR(histogram.percentile_ms(0.9), 90.0, 1.8);
  EXPECT_NEAR(histogram.percentile_ms(0.99), 99.0, 2.0);
  EXPECT_DOUBLE_EQ(histogram.max_ms(), 100.0);
  EXPECT_DOUBLE_EQ(histogram.percentile_ms(1.0), 100.0);
}

TEST(LatencyHistogram, HoldsExtremesAndNothing) {
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.percentile_ms(0.5), 0.0);
  histogram.add(0.0);
  EXPECT_LE(histogram.percentile_ms(0.5), 1e-3);
  histogram.add(1e9);
  EXPECT_DOUBLE_EQ(histogram.max_ms(), 1e9);
  EXPECT_GE(histogram.percentile_ms(1.0), 1e5);
}

TEST(StatusReporter, CountsGapsAsDropped) {
  StatusReporter reporter("tracker");
  for (const int sequence : {5, 6, 9, 10}) reporter.count_sequence(1, sequence);
  EXPECT_EQ(reporter.status(0).dropped, 2);
}

TEST(StatusReporter, LateAndRepeatedMessagesAreNoGaps) {
  StatusReporter reporter("tracker");
  for (const int sequence : {0, 1, 1, 0, 2, 3}) reporter.count_sequence(1, sequence);
  EXPECT_EQ(reporter.status(0).dropped, 0);
}

TEST(StatusReporter, ANewSessionIsNoGap) {
  StatusReporter reporter("tracker");
  reporter.count_sequence(1, 100);
  reporter.count_sequence(2, 0);
  reporter.count_sequence(2, 1);
  EXPECT_EQ(reporter.status(0).dropped, 0);
}

TEST(StatusReporter, DropsAddUpToWhatWasLostAtRandom) {
  base::Random random(7);
  StatusReporter reporter("tracker");
  std::int64_t lost = 0;
  reporter.count_sequence(1, 0);
  for (int sequence = 1; sequence < 1000; ++sequence) {
    if (random.uniform() < 0.3 && sequence < 999) {
      ++lost;
    } else {
      reporter.count_sequence(1, sequence);
    }
  }
  EXPECT_EQ(reporter.status(0).dropped, lost);
}

TEST(StatusReporter, TellsWhoAndHow) {
  StatusReporter reporter("tracker");
  reporter.count_frame(10.0);
  reporter.count_frame(20.0);
  reporter.count_rejected("RGBD: width is negative");
  reporter.set_state("lost");
  const messages::ServiceStatus status = reporter.status(42);
  EXPECT_EQ(status.utime, 42);
  EXPECT_EQ(status.service, "tracker");
  EXPECT_EQ(status.pid, getpid());
  EXPECT_FALSE(status.host.empty());
  EXPECT_EQ(status.frames, 2);
  EXPECT_EQ(status.rejected, 1);
  EXPECT_EQ(status.last_rejection, "RGBD: width is negative");
  EXPECT_EQ(status.state, "lost");
  EXPECT_DOUBLE_EQ(status.latency_max_ms, 20.0);
  EXPECT_GT(status.cpu_seconds, 0.0);
  EXPECT_GT(status.peak_memory_bytes, 1 << 20);
}

}  // namespace
}  // namespace eg::service
