#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/features/line_segment.hpp"

namespace eg::features {

/// Which surface beside a segment the segment belongs to.
enum class LineOwner { both, left, right };

/// One depth reading beside a segment, as inverse depth, in which a line in space is linear along its image.
struct LineDepthSample {
  double along = 0.0;          ///< position on the segment: -1 at its start, 1 at its end
  double across = 0.0;         ///< distance from the segment towards the owner's side, pixels
  double inverse_depth = 0.0;  ///< 1/m
  double sigma = 0.0;          ///< 1/m, of the sensor's noise
};

struct LineDepthSamples {
  LineOwner owner = LineOwner::both;
  int expected = 0;  ///< how many samples there would be if every pixel had a depth
  std::vector<LineDepthSample> samples;
};

/// Reads the depth image (CV_32FC1, metres) along a segment. The depths on both sides, a few pixels off the segment,
/// decide whose it is: where they jump, the nearer surface owns the edge, and where only one side has depth (the shadow
/// of structured light lies on the far one) that side does. An owned segment is sampled at two distances on the owner's
/// side, so that the slope of the surface can be taken out; otherwise the samples lie on the segment.
LineDepthSamples sample_line_depth(const cv::Mat& depth, const Segment& segment);

}  // namespace eg::features
