#include "common/synthetic/renderer.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <opencv2/core.hpp>

#include "common/geometry/so3.hpp"
#include "common/image/rectifier.hpp"
#include "common/synthetic/depth_encoding.hpp"
#include "common/synthetic/sequence.hpp"

namespace eg::synthetic {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

geometry::CameraModel camera(const char* name) { return *geometry::find_camera(name); }

/// Every camera that makes its own demands: plain, y axis up, strong distortion.
class EveryCamera : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Cameras, EveryCamera, testing::Values("synthetic", "icl", "tum_fr1"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST_P(EveryCamera, AgreesWithCastingEveryRayThroughTheWholeScene) {
  const Renderer renderer(*make_scene("room", 1), camera(GetParam()));
  const Trajectory trajectory = *make_trajectory("room");
  int surprises = 0;
  for (const double t : {0.0, 9.0, 23.0}) {
    const geometry::Pose world_from_camera = trajectory.world_from_camera(t);
    const Rendering rendering = renderer.render(world_from_camera);
    for (int y = 3; y < 480; y += 17) {
      for (int x = 1; x < 640; x += 19) {
        const Vector2d ray = ray_of_pixel(renderer.camera(), Vector2d(x, y));
        const auto hit = cast_ray(renderer.scene(), world_from_camera.translation,
                                  world_from_camera.rotation * Vector3d(ray.x(), ray.y(), 1.0), 100.0);
        ASSERT_TRUE(hit.has_value());
        const int surface = rendering.surface.at<std::int16_t>(y, x);
        ASSERT_GE(surface, 0);
        // Where two coplanar surfaces meet either may win; their depth is the same.
        surprises += surface != hit->surface ? 1 : 0;
        EXPECT_NEAR(rendering.depth.at<float>(y, x), hit->distance, 1e-5) << x << " " << y;
      }
    }
  }
  EXPECT_LE(surprises, 2);
}

TEST_P(EveryCamera, APixelSeenAgainElsewhereIsTheSamePoint) {
  const Renderer renderer(*make_scene("slanted", 1), camera(GetParam()));
  const Trajectory trajectory = *make_trajectory("slanted");
  const geometry::Pose world_from_a = trajectory.world_from_camera(4.0);
  const geometry::Pose world_from_b = trajectory.world_from_camera(4.8);
  const Rendering a = renderer.render(world_from_a);
  const Rendering b = renderer.render(world_from_b);
  int same_surface = 0;
  for (int y = 10; y < 470; y += 9) {
    for (int x = 10; x < 630; x += 9) {
      const Vector2d ray = ray_of_pixel(renderer.camera(), Vector2d(x, y));
      const Vector3d world = world_from_a * (a.depth.at<float>(y, x) * Vector3d(ray.x(), ray.y(), 1.0));
      const Vector3d in_b = world_from_b.inverse() * world;
      const Vector2d pixel = distorted_pixel(renderer.camera(), in_b.hnormalized());
      if (in_b.z() <= 0 || !renderer.camera().contains(pixel)) continue;
      const cv::Point nearest(static_cast<int>(pixel.x() + 0.5), static_cast<int>(pixel.y() + 0.5));
      const int surface = a.surface.at<std::int16_t>(y, x);
      if (b.surface.at<std::int16_t>(nearest) != surface) continue;
      ++same_surface;
      // The point that b sees at the nearest pixel lies on the same plane, and within a pixel's size of ours.
      const Vector2d other = ray_of_pixel(renderer.camera(), Vector2d(nearest.x, nearest.y));
      const Vector3d seen = world_from_b * (b.depth.at<float>(nearest) * Vector3d(other.x(), other.y(), 1.0));
      const auto plane = renderer.scene().surfaces[static_cast<std::size_t>(surface)].plane();
      EXPECT_NEAR(plane.signed_distance(seen), 0.0, 1e-5);
      EXPECT_NEAR(plane.signed_distance(world), 0.0, 1e-5);
      const double cosine = std::abs(plane.normal.dot((world - world_from_b.translation).normalized()));
      EXPECT_LT((seen - world).norm(), 0.8 * in_b.z() / 480.0 / cosine);
    }
  }
  EXPECT_GT(same_surface, 1500);
}

TEST(Renderer, ParallelWallHasConstantDepth) {
  const Renderer renderer(*make_scene("corner", 1), camera("synthetic"));
  Trajectory ahead;  // looks along +x at the wall x = 1.8
  ahead.z.offset = 1.5;
  const Rendering rendering = renderer.render(ahead.world_from_camera(0.0));
  for (int x = 0; x < 200; x += 10) EXPECT_FLOAT_EQ(rendering.depth.at<float>(240, 320 + x), 1.8F);
  for (int x = 0; x < 640; ++x) {
    const float z = rendering.depth.at<float>(239, x);
    EXPECT_TRUE(z > 1.799F && z < 1.801F) << x;
  }
}

TEST(Renderer, EmptySpaceHasNoDepthAndNoSurface) {
  const Renderer renderer(*make_scene("corner", 1), camera("synthetic"));
  Trajectory away;
  away.z.offset = 1.5;
  away.heading.offset = 1.25 * std::numbers::pi;
  away.tilt.offset = -0.5;
  const Rendering rendering = renderer.render(away.world_from_camera(0.0));
  EXPECT_EQ(cv::countNonZero(rendering.depth), 0);
  EXPECT_EQ(cv::countNonZero(rendering.surface + 1), 0);
}

TEST(Renderer, EdgesAreSmooth) {
  // The picture of a bright and a dark wall must hold values in between along their common edge.
  Scene scene = *make_scene("corner", 1);
  scene.surfaces[1].material.colour = srgb(0x101010);
  const Renderer renderer(scene, camera("synthetic"));
  Trajectory towards_corner;
  towards_corner.z.offset = 1.5;
  towards_corner.heading.offset = 0.25 * std::numbers::pi;
  towards_corner.roll.offset = 0.1;
  const Rendering rendering = renderer.render(towards_corner.world_from_camera(0.0));
  int jumps = 0;
  int smooth_jumps = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 1; x < 639; ++x) {
      const int left = rendering.colour.at<cv::Vec3b>(y, x - 1)[1];
      const int middle = rendering.colour.at<cv::Vec3b>(y, x)[1];
      const int right = rendering.colour.at<cv::Vec3b>(y, x + 1)[1];
      const int height = std::abs(right - left);
      if (height < 50 || rendering.surface.at<std::int16_t>(y, x - 1) == rendering.surface.at<std::int16_t>(y, x + 1)) {
        continue;
      }
      ++jumps;
      smooth_jumps += std::min(std::abs(middle - left), std::abs(middle - right)) > height / 10 ? 1 : 0;
    }
  }
  EXPECT_GT(jumps, 150);
  EXPECT_GT(smooth_jumps, jumps / 4) << "an aliased edge has no value between its sides'";
}

TEST(Renderer, DoesNotDependOnTheNumberOfThreads) {
  const auto render = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Renderer renderer(*make_scene("room", 3), camera("synthetic"));
    return renderer.render(make_trajectory("room")->world_from_camera(2.0));
  };
  const Rendering one = render(1);
  const Rendering two = render(2);
  EXPECT_TRUE(same_bytes(one.colour, two.colour));
  EXPECT_TRUE(same_bytes(one.depth, two.depth));
  EXPECT_TRUE(same_bytes(one.surface, two.surface));
}

TEST(Renderer, TheRectifierUndoesTheLensOfADistortedRendering) {
  SequenceOptions options;
  options.scene = "slanted";
  options.camera = camera("tum_fr1");
  const SyntheticSequence distorted = *SyntheticSequence::make(options);
  options.camera.distortion = {};
  const SyntheticSequence straight = *SyntheticSequence::make(options);
  image::Rectifier rectifier;
  const image::RectifiedFrame rectified = rectifier.rectify(distorted.frame(30));
  const Rendering expected = straight.render(30);
  EXPECT_FALSE(rectified.camera.has_distortion());
  const int left = static_cast<int>(std::lround(options.camera.cx - rectified.camera.cx));
  const int top = static_cast<int>(std::lround(options.camera.cy - rectified.camera.cy));
  int compared = 0;
  int close = 0;
  for (int y = 0; y < rectified.camera.height; y += 5) {
    for (int x = 0; x < rectified.camera.width; x += 5) {
      const float z = rectified.depth.at<float>(y, x);
      if (z <= 0) continue;
      ++compared;
      close += std::abs(z - expected.depth.at<float>(top + y, left + x)) < 0.01F ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 10000);
  EXPECT_GT(close, 0.985 * compared) << "but for depth edges";
}

TEST(PixelRays, InvertTheDistortionExactly) {
  for (const char* name : {"tum_fr1", "tum_fr2", "icl"}) {
    const geometry::CameraModel model = camera(name);
    for (double y = -1; y <= 480; y += 40.1) {
      for (double x = -1; x <= 640; x += 40.1) {
        const Vector2d ray = ray_of_pixel(model, {x, y});
        EXPECT_NEAR((distorted_pixel(model, ray) - Vector2d(x, y)).norm(), 0.0, 1e-9) << name << " " << x << " " << y;
      }
    }
  }
}

TEST(DepthEncoding, RoundsAndDropsWhatDoesNotFit) {
  const cv::Mat metres = (cv::Mat_<float>(1, 5) << 0.0F, 1.0F, 2.00006F, 13.107F, 13.2F);
  const cv::Mat raw = encode_depth(metres, 5000.0);
  EXPECT_EQ(raw.at<std::uint16_t>(0), 0);
  EXPECT_EQ(raw.at<std::uint16_t>(1), 5000);
  EXPECT_EQ(raw.at<std::uint16_t>(2), 10000);
  EXPECT_EQ(raw.at<std::uint16_t>(3), 65535);
  EXPECT_EQ(raw.at<std::uint16_t>(4), 0) << "beyond 16 bits";
  EXPECT_FLOAT_EQ(decode_depth(raw, 5000.0).at<float>(2), 2.0F);
}

}  // namespace
}  // namespace eg::synthetic
