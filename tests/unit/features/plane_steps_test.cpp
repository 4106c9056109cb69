// Surfaces some millimetres before or behind one another, seen by a sensor whose disparity comes in whole steps.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/features/plane_extraction.hpp"
#include "common/geometry/so3.hpp"
#include "tests/support/plane_scenes.hpp"

namespace eg::features {
namespace {

using test::plane_through;
using test::PlaneScene;
using test::vga_camera;

/// A part of the image that shows the wall moved by `step` metres towards the camera, along the wall's normal.
struct Panel {
  cv::Rect area;
  double step = 0;
};

/// The depth of a wall with panels, in disparities of 1/8 pixel with a sixth of a step of
/// noise (Handa, Whelan, McDonald, Davison, ICRA 2014).
cv::Mat wall_with(const std::vector<Panel>& panels, const geometry::Plane& wall, const geometry::CameraModel& camera) {
  constexpr double kStepsPerInverseMetre = 8 * 525.0 * 0.075;
  constexpr double kSigma = 1.0 / 6.0;  // steps
  base::Random random(11);
  cv::Mat depth(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      double distance = wall.distance;
      for (const Panel& panel : panels) {
        if (panel.area.contains({u, v})) distance = wall.distance - panel.step;
      }
      const double z = -distance / wall.normal.dot(camera.ray({u, v}));
      const double disparity = std::round(kStepsPerInverseMetre / z + kSigma * random.normal());
      depth.at<float>(v, u) = static_cast<float>(kStepsPerInverseMetre / disparity);
    }
  }
  return depth;
}

class PlaneSteps : public testing::Test {
 protected:
  /// The found plane that holds a pixel.
  [[nodiscard]] const PlaneFeature* at(int u, int v) const {
    const int label = result_.labels.at<std::uint8_t>(v, u);
    return label > 0 ? &result_.planes[static_cast<std::size_t>(label - 1)] : nullptr;
  }

  void expect_plane_at(int u, int v, double step, double max_degrees = 0.15) const {
    const PlaneFeature* found = at(u, v);
    ASSERT_NE(found, nullptr) << u << ", " << v;
    EXPECT_LT(geometry::axial_angle(found->plane.normal, wall_.normal) * 180 / M_PI, max_degrees) << u << ", " << v;
    EXPECT_NEAR(found->plane.distance, wall_.distance - step, 0.003) << u << ", " << v;
  }

  geometry::CameraModel camera_ = vga_camera();
  geometry::Plane wall_ = plane_through({0, 0, 3}, {0.57, 0.0, -0.82});
  PlaneExtraction result_;
};

TEST_F(PlaneSteps, PicturesBesideTheirFramesAreNoPartOfTheWall) {
  wall_ = plane_through({0, 0, 3.2}, {0.12, 0.1, -1.0});
  std::vector<Panel> panels;
  for (const int left : {45, 185, 385, 535}) {
    const cv::Rect picture(left, 113, 100, 115);
    panels.push_back({cv::Rect(picture.x - 7, picture.y - 7, picture.width + 14, picture.height + 14), 0.035});
    panels.push_back({picture, 0.02});
  }
  result_ = extract_planes(wall_with(panels, wall_, camera_), camera_);
  expect_plane_at(320, 400, 0.0);
  expect_plane_at(235, 170, 0.02, 0.5);
}

TEST_F(PlaneSteps, FramesThinnerThanABlockDoNotTiltAPlane) {
  wall_ = plane_through({0, 0, 2.8}, {0.12, 0.35, -1.0});
  const cv::Rect front(165, 180, 330, 115);
  const std::vector<Panel> frames = {
      {front, -0.02}, {{172, 184, 101, 103}, 0.0}, {{279, 184, 101, 103}, 0.0}, {{386, 184, 101, 103}, 0.0}};
  cv::Mat depth = cv::Mat::zeros(camera_.height, camera_.width, CV_32FC1);
  wall_with(frames, wall_, camera_)(front).copyTo(depth(front));
  result_ = extract_planes(depth, camera_);
  expect_plane_at(320, 240, 0.0);
}

TEST_F(PlaneSteps, AWindowPaneBehindItsFrameIsNoPartOfTheWallThatItDoesNotTouch) {
  wall_ = plane_through({0, 0, 2.2}, {0.3, 0.1, -1.0});
  const cv::Rect pane(330, 0, 310, 400);
  const cv::Rect frame(pane.x - 40, pane.y, pane.width + 40, pane.height + 40);
  result_ = extract_planes(wall_with({{frame, 0.06}, {pane, 0.004}}, wall_, camera_), camera_);
  expect_plane_at(470, 240, 0.004, 0.05);
  expect_plane_at(120, 240, 0.0, 0.05);
}

TEST_F(PlaneSteps, AWallWithSeveralStepsOfDisparityIsOnePlane) {
  for (const double tilt : {0.15, 0.3, 0.6}) {
    wall_ = plane_through({0, 0, 3}, {tilt, 0.02, -1.0});
    result_ = extract_planes(wall_with({}, wall_, camera_), camera_);
    ASSERT_FALSE(result_.planes.empty());
    EXPECT_GT(result_.planes[0].support, 0.9 * 640 * 480) << "tilt " << tilt;
    expect_plane_at(320, 240, 0.0);
  }
}

}  // namespace
}  // namespace eg::features
