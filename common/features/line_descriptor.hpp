#pragma once

#include <opencv2/core/mat.hpp>

#include "common/features/features.hpp"
#include "common/features/line_segment.hpp"

namespace eg::features {

/// The gradients of an image (CV_16SC1 each), made once for all descriptors.
struct GradientImages {
  cv::Mat dx, dy;
};

/// Fills `gradients`, whose memory it uses again.
void compute_gradients(const cv::Mat& grey, GradientImages& gradients);

/// Line band descriptor (LBD: Zhang and Koch, J. Visual Communication and Image Representation 2013): bands parallel to
/// the segment, each with the mean and standard deviation over its rows of the summed positive and negative gradients
/// along and across the segment. Made binary by comparing the eight numbers of 32 pairs of bands, so that Hamming
/// distance compares segments. Segments must be turned by polarity (see Segment) for descriptors of two images to
/// agree.
Descriptor describe_segment(const GradientImages& gradients, const Segment& segment);

/// Number of bits that differ, 0..256.
int hamming_distance(const Descriptor& a, const Descriptor& b);

}  // namespace eg::features
