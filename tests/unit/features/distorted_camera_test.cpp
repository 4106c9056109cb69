// A lens with distortion must not be seen in the features: they are compared with those of the same camera, in the same
// place, without distortion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/features/feature_extractor.hpp"
#include "common/features/line_descriptor.hpp"
#include "common/geometry/so3.hpp"
#include "common/image/rectifier.hpp"
#include "common/synthetic/sequence.hpp"

namespace eg::features {
namespace {

constexpr double kDegree = 0.0175;  // radians

/// One view with the distorting lens, rectified, and with a straight one.
struct Views {
  FrameFeatures straight;
  FrameFeatures rectified;
};

std::vector<Views> make_views() {
  synthetic::SequenceOptions options;
  options.camera = *geometry::find_camera("tum_fr1");
  const auto distorted = synthetic::SyntheticSequence::make(options).value();
  options.camera.distortion = {};
  const auto straight = synthetic::SyntheticSequence::make(options).value();
  const auto features_of = [](const image::RgbdFrame& frame) {
    return FeatureExtractor().extract(image::Rectifier().rectify(frame));
  };
  std::vector<Views> views;
  for (const int index : {0, 120, 300}) {
    views.push_back({features_of(straight.frame(index)), features_of(distorted.frame(index))});
  }
  return views;
}

const std::vector<Views>& views() {
  static const std::vector<Views> made = make_views();
  return made;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Whether a ray is so far inside that both cameras see what is around it.
bool well_inside(const geometry::CameraModel& camera, const Eigen::Vector2d& pixel) {
  constexpr double kMargin = 40.0;
  return pixel.x() > kMargin && pixel.y() > kMargin && pixel.x() < camera.width - kMargin &&
         pixel.y() < camera.height - kMargin;
}

const DirectionFeature* nearest(const FrameFeatures& frame, const DirectionFeature& to) {
  const DirectionFeature* best = nullptr;
  for (const DirectionFeature& direction : frame.directions) {
    if (direction.kind != to.kind) continue;
    const double angle = geometry::axial_angle(direction.direction, to.direction);
    if (best == nullptr || angle < geometry::axial_angle(best->direction, to.direction)) best = &direction;
  }
  return best;
}

TEST(DistortedCamera, PointsAreWhereAStraightLensHasThem) {
  std::vector<double> right, down, depth;
  int looked_for = 0;
  for (const auto& [straight, rectified] : views()) {
    for (const PointFeature& expected : straight.points) {
      const Eigen::Vector2d pixel = rectified.camera.project(straight.camera.ray(expected.pixel));
      if (expected.octave > 1 || !expected.has_depth() || !well_inside(rectified.camera, pixel)) continue;
      ++looked_for;
      for (const PointFeature& found : rectified.points) {
        if ((found.pixel - pixel).norm() > 2.0 || hamming_distance(found.descriptor, expected.descriptor) > 50)
          continue;
        right.push_back(found.pixel.x() - pixel.x());
        down.push_back(found.pixel.y() - pixel.y());
        if (found.has_depth()) depth.push_back(found.depth / expected.depth - 1.0);
        break;
      }
    }
  }
  EXPECT_GT(looked_for, 300);
  EXPECT_GT(static_cast<double>(right.size()), 0.5 * looked_for);
  EXPECT_NEAR(median(right), 0.0, 0.2) << "pixels";
  EXPECT_NEAR(median(down), 0.0, 0.2) << "pixels";
  EXPECT_NEAR(median(depth), 0.0, 1e-3);
}

TEST(DistortedCamera, DirectionsAreThoseOfAStraightLens) {
  std::vector<double> normals, vanishing;
  int large = 0;
  for (const auto& [straight, rectified] : views()) {
    for (const DirectionFeature& expected : straight.directions) {
      const bool is_normal = expected.kind == DirectionKind::plane_normal;
      if (is_normal && expected.support < 0.05 * 640 * 480) continue;
      if (expected.kind == DirectionKind::potential_direction || (!is_normal && expected.support < 6)) continue;
      ++large;
      const DirectionFeature* found = nearest(rectified, expected);
      if (found == nullptr || geometry::axial_angle(found->direction, expected.direction) > 2 * kDegree) continue;
      (is_normal ? normals : vanishing).push_back(geometry::axial_angle(found->direction, expected.direction));
    }
  }
  EXPECT_GT(large, 12);
  EXPECT_GE(static_cast<double>(normals.size() + vanishing.size()), 0.9 * large);
  EXPECT_LT(median(normals), 0.05 * kDegree);
  EXPECT_LT(median(vanishing), 0.2 * kDegree);
}

/// Lines of the frame that follow a side of the image, in its outermost twentieth: what a seam between seen and unseen
/// pixels looks like.
int lines_along_the_border(const FrameFeatures& frame) {
  const double margin_x = 0.05 * frame.camera.width;
  const double margin_y = 0.05 * frame.camera.height;
  return static_cast<int>(std::count_if(frame.lines.begin(), frame.lines.end(), [&](const LineFeature& line) {
    const auto& a = line.start_pixel;
    const auto& b = line.end_pixel;
    const auto both = [](double p, double q, double margin, double side) {
      return std::max(p, q) < margin || std::min(p, q) > side - 1 - margin;
    };
    return both(a.x(), b.x(), margin_x, frame.camera.width) || both(a.y(), b.y(), margin_y, frame.camera.height);
  }));
}

TEST(DistortedCamera, TheBorderOfTheRectifiedImageIsNoLine) {
  int straight = 0;
  int rectified = 0;
  for (const Views& view : views()) {
    straight += lines_along_the_border(view.straight);
    rectified += lines_along_the_border(view.rectified);
  }
  EXPECT_LE(rectified, straight + 3);
}

}  // namespace
}  // namespace eg::features
