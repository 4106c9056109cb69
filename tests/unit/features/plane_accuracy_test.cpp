// Statistics over random rooms with exact truth: accuracy, recall and consistency of the covariance.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/features/plane_extraction.hpp"
#include "common/geometry/so3.hpp"
#include "tests/support/plane_scenes.hpp"

namespace eg::features {
namespace {

enum class Noise { none, white, correlated };

/// A camera anywhere in a room whose walls are up to 10 degrees off square.
test::PlaneScene random_room(base::Random& random) {
  const auto direction = [&] {
    return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  };
  const Eigen::Matrix3d camera_from_room = geometry::so3_exp(random.uniform(0.0, 3.0) * direction());
  test::PlaneScene scene{test::vga_camera(random.uniform() < 0.5 ? 525.0 : -525.0), {}};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Eigen::Vector3d normal = -sign * camera_from_room.col(axis) + 0.1 * direction();
      scene.planes.push_back({normal.normalized(), random.uniform(0.9, 2.6)});
    }
  }
  return scene;
}

/// (normal, distance) error in two tangential directions and the distance, squared and divided by its covariance: chi
/// squared with 3 degrees of freedom if the covariance is right.
double normalised_squared_error(const PlaneFeature& found, const geometry::Plane& truth) {
  Eigen::Matrix<double, 4, 3> basis = Eigen::Matrix<double, 4, 3>::Zero();
  basis.topLeftCorner<3, 2>() = geometry::tangent_basis(found.plane.normal);
  basis(3, 2) = 1.0;
  Eigen::Vector4d error;
  error << found.plane.normal - truth.normal, found.plane.distance - truth.distance;
  const Eigen::Vector3d reduced = basis.transpose() * error;
  return reduced.dot((basis.transpose() * found.covariance * basis).inverse() * reduced);
}

struct Statistics {
  std::vector<double> angles;  ///< degrees
  std::vector<double> squared_errors;
  int large_planes = 0;  ///< over 5 % of the image
  int found_planes = 0;
  int false_planes = 0;

  void add(const test::PlaneScene& scene, const PlaneExtraction& extraction) {
    std::vector<int> pixels(scene.planes.size(), 0);
    const int total = scene.camera.width * scene.camera.height;
    for (int i = 0; i < total; i += 16) {
      pixels[static_cast<std::size_t>(scene.hit(i % scene.camera.width, i / scene.camera.width).first)] += 16;
    }
    std::vector<bool> used(extraction.planes.size(), false);
    for (std::size_t i = 0; i < scene.planes.size(); ++i) {
      const bool large = pixels[i] > 0.05 * total;
      large_planes += large ? 1 : 0;
      for (std::size_t j = 0; j < extraction.planes.size(); ++j) {
        const PlaneFeature& found = extraction.planes[j];
        const double angle = std::acos(std::min(1.0, found.plane.normal.dot(scene.planes[i].normal))) * 180 / M_PI;
        if (used[j] || angle > 3.0 || std::abs(found.plane.distance - scene.planes[i].distance) > 0.05) continue;
        used[j] = true;
        if (large) {
          ++found_planes;
          angles.push_back(angle);
          squared_errors.push_back(normalised_squared_error(found, scene.planes[i]));
        }
        break;
      }
    }
    false_planes += static_cast<int>(std::count(used.begin(), used.end(), false));
  }

  [[nodiscard]] double angle_quantile(double q) {
    std::sort(angles.begin(), angles.end());
    return angles[static_cast<std::size_t>(q * static_cast<double>(angles.size() - 1))];
  }

  [[nodiscard]] double mean_squared_error() const {
    double sum = 0;
    for (const double e : squared_errors) sum += e;
    return sum / static_cast<double>(squared_errors.size());
  }
};

class RandomRooms : public testing::TestWithParam<Noise> {
 protected:
  /// Without the part of the covariance that stands for calibration errors, which these images do not have.
  static Statistics run(Noise noise) {
    PlaneOptions options;
    options.systematic_angle = 0.0;
    options.systematic_distance = 0.0;
    options.rounding = 0.0;
    PlaneExtractor extractor(options);
    base::Random random(7);
    Statistics statistics;
    constexpr int kRooms = 40;
    for (int i = 0; i < kRooms; ++i) {
      const test::PlaneScene scene = random_room(random);
      cv::Mat depth = scene.depth();
      if (noise == Noise::white) test::add_white_noise(depth, random);
      if (noise == Noise::correlated) test::add_correlated_noise(depth, random, 5);
      statistics.add(scene, extractor.extract(depth, scene.camera));
    }
    return statistics;
  }
};

TEST_P(RandomRooms, LargePlanesAreFoundAccuratelyWithTheRightCovariance) {
  Statistics statistics = run(GetParam());
  RecordProperty("median_angle_degrees", std::to_string(statistics.angle_quantile(0.5)));
  RecordProperty("p95_angle_degrees", std::to_string(statistics.angle_quantile(0.95)));
  RecordProperty("normalised_squared_error", std::to_string(statistics.mean_squared_error()));
  EXPECT_GE(statistics.found_planes, 0.95 * statistics.large_planes);
  EXPECT_LE(statistics.false_planes, 2);
  EXPECT_LT(statistics.angle_quantile(0.5), 0.03);
  EXPECT_LT(statistics.angle_quantile(0.95), 0.2);
  if (GetParam() != Noise::none) {
    constexpr double kExpected = 3.0;  // degrees of freedom
    EXPECT_GT(statistics.mean_squared_error(), kExpected / 2);
    EXPECT_LT(statistics.mean_squared_error(), kExpected * 2);
  }
}

INSTANTIATE_TEST_SUITE_P(Noise, RandomRooms, testing::Values(Noise::none, Noise::white, Noise::correlated));

}  // namespace
}  // namespace eg::features
