#include "common/tracking/pose_optimizer.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "common/tracking/observability.hpp"
#include "common/tracking/pose_covariance.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Pose;
using test::kDegree;

/// Makes problems around a true pose, exact or with the noise that the factors state.
class ProblemMaker {
 public:
  ProblemMaker(std::uint64_t seed, const char* camera, double noise = 0.0)
      : random_(seed), noise_(noise), truth_(test::random_pose(random_)) {
    problem_.camera = *geometry::find_camera(camera);
    problem_.prior = known_within(start(0.03, 0.05), 10.0, 10.0);
  }

  [[nodiscard]] const Pose& truth() const { return truth_; }
  PoseProblem& problem() { return problem_; }
  base::Random& random() { return random_; }

  /// Some degrees and centimetres beside the truth.
  Pose start(double rotation, double translation) {
    return {geometry::so3_exp(rotation * test::random_direction(random_)) * truth_.rotation,
            truth_.translation + translation * test::random_direction(random_)};
  }

  ProblemMaker& add_points(int count, bool depth) {
    for (int i = 0; i < count; ++i) {
      const Vector3d in_camera = visible_point();
      PointFactor factor{world(in_camera), problem_.camera.project(in_camera), random_.uniform(0.5, 2.0)};
      factor.pixel += Vector2d(noise(factor.pixel_sigma), noise(factor.pixel_sigma));
      if (depth) {
        factor.depth_sigma = 0.01;
        factor.depth = in_camera.z() + noise(factor.depth_sigma);
      }
      problem_.points.push_back(factor);
    }
    return *this;
  }

  ProblemMaker& add_lines(int count) {
    for (int i = 0; i < count; ++i) {
      const Vector3d start = visible_point();
      const Vector3d end = visible_point();
      const Vector2d a = problem_.camera.project(start);
      const Vector2d b = problem_.camera.project(end);
      const Vector2d across = Vector2d(a.y() - b.y(), b.x() - a.x()).normalized();
      const Vector3d line =
          Vector2d(a + noise(1.0) * across).homogeneous().cross(Vector2d(b + noise(1.0) * across).homogeneous());
      problem_.lines.push_back({world(start), world(end), line / line.head<2>().norm()});
    }
    return *this;
  }

  ProblemMaker& add_plane(const Vector3d& normal_in_camera) {
    const Vector3d normal = normal_in_camera.normalized();
    const Vector3d on_plane = visible_point();
    const geometry::Plane plane{normal, -normal.dot(on_plane)};
    PlaneFactor factor{geometry::transform(truth_.inverse(), plane), on_plane, 0.005};
    factor.centroid_in_camera += noise(factor.sigma) * normal;
    problem_.planes.push_back(factor);
    return add_direction(normal);
  }

  ProblemMaker& add_direction(const Vector3d& in_camera) {
    const Vector3d direction = in_camera.normalized();
    problem_.directions.push_back({truth_.rotation.transpose() * direction,
                                   test::disturbed_direction(direction, noise_ * 0.005, random_),
                                   test::tangential_covariance(direction, 0.005)});
    return *this;
  }

  [[nodiscard]] double rotation_error(const PoseSolution& solution) const {
    return geometry::rotation_angle_between(solution.camera_from_world.rotation, truth_.rotation);
  }
  [[nodiscard]] double translation_error(const PoseSolution& solution) const {
    return (solution.camera_from_world.translation - truth_.translation).norm();
  }

 private:
  double noise(double sigma) { return noise_ * sigma * random_.normal(); }
  [[nodiscard]] Vector3d world(const Vector3d& in_camera) const { return truth_.inverse() * in_camera; }
  Vector3d visible_point() {
    return problem_.camera.unproject(
        {random_.uniform(0, problem_.camera.width), random_.uniform(0, problem_.camera.height)},
        random_.uniform(0.8, 4.0));
  }

  base::Random random_;
  double noise_;
  Pose truth_;
  PoseProblem problem_;
};

/// The prior that the tracker has is weak; for exact answers it must be all but absent.
void forget_prior(PoseProblem& problem) { problem.prior = known_within(problem.prior.camera_from_world, 1e6, 1e6); }

class OptimizePose : public testing::TestWithParam<const char*> {
 protected:
  static void expect_exact(ProblemMaker& maker) {
    forget_prior(maker.problem());
    const PoseSolution solution = optimize_pose(maker.problem(), maker.start(0.05, 0.05), FreeParameters::pose);
    EXPECT_LT(maker.rotation_error(solution), 1e-6);
    EXPECT_LT(maker.translation_error(solution), 1e-6);
  }
};

TEST_P(OptimizePose, IsExactFromPointsWithDepth) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) expect_exact(ProblemMaker(seed, GetParam()).add_points(10, true));
}

TEST_P(OptimizePose, IsExactFromPointsWithoutDepth) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) expect_exact(ProblemMaker(seed, GetParam()).add_points(12, false));
}

TEST_P(OptimizePose, IsExactFromThreePlanes) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    expect_exact(
        ProblemMaker(seed, GetParam()).add_plane({1, 0.2, -1}).add_plane({-1, 0, -1}).add_plane({0, -1, -0.4}));
  }
}

TEST_P(OptimizePose, IsExactFromLines) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) expect_exact(ProblemMaker(seed, GetParam()).add_lines(10));
}

TEST_P(OptimizePose, IsExactFromTwoPlanesAndTwoPoints) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    expect_exact(ProblemMaker(seed, GetParam()).add_plane({1, 0.2, -1}).add_plane({-1, 0, -1}).add_points(2, true));
  }
}

TEST_P(OptimizePose, TranslationAloneKeepsTheRotation) {
  ProblemMaker maker(1, GetParam());
  maker.add_points(10, true);
  forget_prior(maker.problem());
  const Pose start{maker.truth().rotation, maker.truth().translation + Vector3d(0.1, -0.1, 0.05)};
  const PoseSolution solution = optimize_pose(maker.problem(), start, FreeParameters::translation);
  EXPECT_LT(geometry::rotation_angle_between(solution.camera_from_world.rotation, start.rotation), 1e-12);
  EXPECT_LT(maker.translation_error(solution), 1e-7);
  EXPECT_TRUE((solution.information.topRows<3>().array() == 0.0).all());
  EXPECT_GT(solution.information(5, 5), 0.0);
}

TEST_P(OptimizePose, LeavesOutliersOut) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    ProblemMaker maker(seed, GetParam(), 1.0);
    maker.add_points(100, true).add_lines(10).add_plane({1, 0, -1}).add_plane({-1, 0, -1});
    for (std::size_t i = 0; i < 30; ++i) {
      maker.problem().points[i].pixel += Vector2d(maker.random().uniform(20, 60), maker.random().uniform(-60, 60));
    }
    for (std::size_t i = 0; i < 3; ++i) maker.problem().lines[i].image_line.z() += 25.0;
    forget_prior(maker.problem());
    const PoseSolution solution = optimize_pose(maker.problem(), maker.start(0.02, 0.03), FreeParameters::pose);
    EXPECT_LT(maker.rotation_error(solution), 0.3 * kDegree) << "seed " << seed;
    EXPECT_LT(maker.translation_error(solution), 0.006) << "seed " << seed;
    for (std::size_t i = 0; i < 30; ++i) EXPECT_FALSE(solution.point_inliers[i]);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_FALSE(solution.line_inliers[i]);
    EXPECT_GT(solution.inlier_points(), 56) << "95 % of the other 70 are within the 95 % gate";
    EXPECT_GE(solution.inlier_lines(), 5);
    EXPECT_EQ(solution.inlier_planes(), 2);
  }
}

TEST_P(OptimizePose, ADepthOfTheBackgroundDoesNotPull) {
  // Every third point lies on an outline, and its depth is that of the wall half a metre behind. Its pixel is right.
  double worst = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    ProblemMaker maker(seed, GetParam(), 1.0);
    maker.add_points(90, true);
    for (std::size_t i = 0; i < 90; i += 3) maker.problem().points[i].depth += 0.5;
    forget_prior(maker.problem());
    const PoseSolution solution = optimize_pose(maker.problem(), maker.start(0.01, 0.01), FreeParameters::pose);
    worst = std::max(worst, maker.translation_error(solution));
    for (std::size_t i = 0; i < 90; i += 3) EXPECT_FALSE(solution.depth_inliers[i]);
    EXPECT_GT(solution.inlier_points(), 80) << "of the pixels 95 % are within the 95 % gate";
  }
  EXPECT_LT(worst, 0.006);
}

TEST_P(OptimizePose, CovarianceIsConsistent) {
  // The mean of chi²(6) over 600 trials has a standard deviation of sqrt(12 / 600) = 0.14. Huber weights and gates cut
  // some information from the noise's tails, which makes the covariance a little optimistic: up to 20 %.
  double sum = 0.0;
  constexpr int kTrials = 600;
  for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
    ProblemMaker maker(seed, GetParam(), 1.0);
    maker.add_points(25, true).add_lines(6).add_plane({1, 0, -1}).add_direction({0, 1, 0});
    forget_prior(maker.problem());
    const PoseSolution solution = optimize_pose(maker.problem(), maker.start(0.01, 0.01), FreeParameters::pose);
    const Pose error = solution.camera_from_world * maker.truth().inverse();
    Vector6d delta;
    delta << geometry::so3_log(error.rotation), error.translation;
    sum += delta.dot(solution.information * delta);
  }
  EXPECT_GT(sum / kTrials, 5.0);
  EXPECT_LT(sum / kTrials, 7.5);
}

TEST_P(OptimizePose, WithoutMeasurementsIsThePrior) {
  ProblemMaker maker(1, GetParam());
  maker.problem().prior = known_within(maker.truth(), 0.1, 0.1);
  const PoseSolution solution = optimize_pose(maker.problem(), maker.start(0.05, 0.05), FreeParameters::pose);
  EXPECT_LT(maker.rotation_error(solution), 1e-6);
  EXPECT_LT(maker.translation_error(solution), 1e-6);
  EXPECT_TRUE(solution.information.isZero()) << "the prior is no measurement";
}

TEST_P(OptimizePose, TheCovarianceOfThePriorCarriesOverToWhatIsNotMeasured) {
  PoseProblem problem;
  problem.prior = known_within({}, 1e-6, 0.02);
  problem.prior.covariance(3, 4) = problem.prior.covariance(4, 3) = 0.5 * 0.02 * 0.02;
  // A wall across x is one millimetre nearer than predicted.
  problem.planes.push_back({{Vector3d::UnitX(), -2.0}, {1.999, 0.0, 1.0}, 1e-5});
  const Vector3d way = optimize_pose(problem, Pose{}, FreeParameters::pose).camera_from_world.translation;
  EXPECT_NEAR(std::abs(way.x()), 0.001, 1e-5);
  EXPECT_NEAR(way.y(), 0.5 * way.x(), 1e-5);
  EXPECT_NEAR(way.z(), 0.0, 1e-6);
}

TEST_P(OptimizePose, PointsBehindTheCameraDoNoHarm) {
  ProblemMaker maker(2, GetParam());
  maker.add_points(10, true);
  const Vector3d behind = maker.truth().inverse() * Vector3d(0.1, 0.1, -2.0);
  maker.problem().points.push_back({behind, {100, 100}, 1.0, 2.0, 0.01});
  forget_prior(maker.problem());
  const PoseSolution solution = optimize_pose(maker.problem(), maker.start(0.02, 0.02), FreeParameters::pose);
  EXPECT_LT(maker.translation_error(solution), 1e-6);
  EXPECT_FALSE(solution.point_inliers.back());
}

TEST_P(OptimizePose, GivesARotationMatrix) {
  ProblemMaker maker(3, GetParam(), 1.0);
  maker.add_points(30, true);
  const Eigen::Matrix3d r =
      optimize_pose(maker.problem(), maker.start(0.1, 0.1), FreeParameters::pose).camera_from_world.rotation;
  EXPECT_TRUE((r * r.transpose()).isIdentity(1e-12));
  EXPECT_NEAR(r.determinant(), 1.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Cameras, OptimizePose, testing::Values("tum_fr3", "icl"),
                         [](const auto& camera) { return std::string(camera.param); });

TEST(Observability, TellsWhatIsUnobserved) {
  ProblemMaker maker(4, "tum_fr3");
  maker.add_plane({0, 0, -1}).add_plane({1, 0, -1});
  forget_prior(maker.problem());
  const auto two_planes =
      observability(optimize_pose(maker.problem(), maker.truth(), FreeParameters::pose).information);
  EXPECT_LT(two_planes.rotation_sigma, 0.05);
  EXPECT_GT(two_planes.translation_sigma, 100.0) << "along the line in which the planes meet";

  maker.add_plane({0, 1, -0.3});
  const auto three_planes =
      observability(optimize_pose(maker.problem(), maker.truth(), FreeParameters::pose).information);
  EXPECT_LT(three_planes.rotation_sigma, 0.02);
  EXPECT_LT(three_planes.translation_sigma, 0.05);

  const auto nothing = observability(Matrix6d::Zero());
  EXPECT_TRUE(std::isinf(nothing.rotation_sigma));
  EXPECT_TRUE(std::isinf(nothing.translation_sigma));
}

TEST(Observability, TranslationIsWhatRotationLeavesOpen) {
  // Two points fix the camera only up to a turn about the line through them, which moves it.
  ProblemMaker maker(5, "tum_fr3");
  maker.add_points(2, true);
  forget_prior(maker.problem());
  const auto observed = observability(optimize_pose(maker.problem(), maker.truth(), FreeParameters::pose).information);
  EXPECT_GT(observed.rotation_sigma, 10.0);
}

TEST(WorldCovariance, IsThatOfALeftPerturbationOfWorldFromCamera) {
  base::Random random(6);
  const Pose world_from_camera = test::random_pose(random);
  Matrix6d root = Matrix6d::Zero();
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = (i / 6 < 3 ? 0.002 : 0.01) * random.normal();
  const Matrix6d covariance = root * root.transpose() + 1e-7 * Matrix6d::Identity();
  const Eigen::LLT<Matrix6d> cholesky(covariance);
  Matrix6d sampled = Matrix6d::Zero();
  constexpr int kSamples = 20'000;
  for (int i = 0; i < kSamples; ++i) {
    Vector6d noise;
    for (double& n : noise) n = random.normal();
    const Pose moved = perturb(world_from_camera.inverse(), cholesky.matrixL() * noise).inverse();
    const Pose error = moved * world_from_camera.inverse();
    Vector6d delta;
    delta << geometry::so3_log(error.rotation), error.translation;
    sampled += delta * delta.transpose() / kSamples;
  }
  const MotionPrior open = known_within({}, 1e6, 1e6);
  const Matrix6d predicted = world_covariance(covariance.inverse(), open, world_from_camera);
  EXPECT_LT((sampled - predicted).norm(), 0.05 * predicted.norm());
  EXPECT_TRUE(predicted.isApprox(predicted.transpose(), 1e-15));
}

TEST(WorldCovariance, ThePriorBoundsWhatIsUnobserved) {
  const MotionPrior prior = known_within({}, 0.1, 0.2);
  const Matrix6d covariance = world_covariance(Matrix6d::Zero(), prior, Pose{});
  EXPECT_NEAR(covariance(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(covariance(5, 5), 0.04, 1e-12);
}

}  // namespace
}  // namespace eg::tracking
