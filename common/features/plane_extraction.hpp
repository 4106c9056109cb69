#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/base/result.hpp"
#include "common/features/features.hpp"
#include "common/geometry/camera_model.hpp"

namespace eg::features {

/// Errors along the depth axis are in standard deviations of one reading (geometry::depth_sigma), so one set of values
/// serves near and far surfaces; all of them shrink if the frame has smaller errors than that (DepthErrors in
/// plane_noise.hpp).
struct PlaneOptions {
  int block_size = 0;               ///< pixels; 0: 10 for 640x480 and in proportion for other sizes
  double min_valid_fraction = 0.5;  ///< of a block's pixels that need a reading
  double max_error = 1.5;           ///< largest rms error of a block or of a part of a plane, sigma
  double max_step = 2.5;            ///< largest mean step between touching parts of one wavy plane, sigma ...
  double max_warp_error = 3.0;      ///< ... and the largest rms error of such a part, sigma ...
  double flatness = 0.012;          ///< ... plus metres: what real walls and the sensor's warp deviate from a plane
  double max_growth_error = 3.0;    ///< largest error of a pixel that joins a region, in the region's rms errors
  double lateral_sigma = 0.8;       ///< pixels; noise sideways, depth noise on steep surfaces (Nguyen 2012: 0.8 to 0.9)
  double min_support_fraction = 0.01;  ///< of the image's pixels: the smallest plane that is reported
  double warp_blocks = 24.0;           ///< side of the area, in blocks, that shares one error of the sensor's warp
  double systematic_angle =
      0.002;  ///< radians; what the calibration of a sensor with warp leaves in a normal, one sigma
  double systematic_distance = 0.003;  ///< relative; what it leaves in a distance, one sigma
  double rounding = 3e-5;  ///< relative, and radians; what depth in whole units of a fraction of a millimetre leaves
};

/// Says which option is out of range.
base::Status validate(const PlaneOptions& options);

struct PlaneExtraction {
  std::vector<PlaneFeature> planes;  ///< by falling support, at most kMaxPlanes
  cv::Mat labels;                    ///< CV_8UC1, the depth image's size: 0 none, i + 1 belongs to planes[i]
  double warp = 0.0;                 ///< of the sensor, as this image shows it (DepthErrors::warp)
};

/// Planes of an organised depth image by agglomerative hierarchical clustering: Feng, Taguchi, Kamat, "Fast plane
/// extraction in organized point clouds using agglomerative hierarchical clustering", ICRA 2014. Two deviations: errors
/// are those of inverse depth in units of the sensor's noise, and a region only merges if each part, not just the
/// whole, fits the common plane, so that a large wall cannot swallow small neighbours
/// (docs/decisions/plane_extraction.md). Keeps its buffers between frames; results depend on the arguments alone. One
/// object per thread.
class PlaneExtractor {
 public:
  /// `options` must be valid.
  explicit PlaneExtractor(const PlaneOptions& options = {});
  ~PlaneExtractor();
  PlaneExtractor(PlaneExtractor&&) noexcept;
  PlaneExtractor& operator=(PlaneExtractor&&) noexcept;

  /// `depth` is CV_32FC1, metres along the optical axis, of any size; zero, negative, NaN and infinite are no reading.
  /// `camera` has no distortion and is the camera of this image size. The result's planes are in the camera frame.
  [[nodiscard]] PlaneExtraction extract(const cv::Mat& depth, const geometry::CameraModel& camera);

 private:
  struct Buffers;
  PlaneOptions options_;
  std::unique_ptr<Buffers> buffers_;
};

/// The same for a single image.
PlaneExtraction extract_planes(const cv::Mat& depth, const geometry::CameraModel& camera,
                               const PlaneOptions& options = {});

}  // namespace eg::features
