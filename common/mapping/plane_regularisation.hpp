#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/mapping/plane_in_image.hpp"

namespace eg::mapping {

/// Takes noise out of the depth readings that lie on planes, and nothing else. Works in inverse depth w = 1/z, where a
/// plane is linear in the pixel and the sensor's noise hardly depends on the distance.
///
/// The image is cut into cells of 8 x 8 pixels. The errors of a cell's readings under a plane, in standard deviations
/// of the sensor (geometry::depth_sigma and its noise sideways), tell whether the cell shows that plane: their mean and
/// their rms must be no larger than the noise `s` of this plane in this frame, which is the rms of its median cell. So
/// a rendered image, without noise, keeps what stands out by a fraction of a millimetre; in a noisy one a step of s
/// standard deviations of one reading is kept. Cells with outlines, creases or steps show no plane. Of several planes
/// the best fitting one counts.
///
/// In such a cell, a reading w with variance (s sigma)² and the plane's w_p with variance V, which follows from the
/// covariance of its parameters, are fused to the least-squares estimate
///   w' = w_p + (w - w_p) V / (V + (s sigma)²).
/// Readings that are more than 3 s standard deviations off stay, as do all others of the image, bit for bit.
///
/// @param depth CV_32FC1, metres along the optical axis, the camera's size; zero, negative, NaN and infinite are no
///   reading and stay what they are
/// @param camera without distortion
/// @param planes of this image; those that project() refuses are left out
/// @return an image of its own. It depends on the arguments alone, for any number of threads.
cv::Mat regularise_depth(const cv::Mat& depth, const geometry::CameraModel& camera,
                         const std::vector<DepthPlane>& planes);

}  // namespace eg::mapping
