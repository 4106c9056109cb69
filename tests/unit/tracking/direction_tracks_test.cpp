#include <gtest/gtest.h>

#include <Eigen/LU>

#include "common/features/direction_evidence.hpp"
#include "common/tracking/direction_tracks.hpp"
#include "tests/support/random_geometry.hpp"

namespace eg::tracking {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using features::DirectionFeature;
using features::DirectionKind;

constexpr double kNoise = 0.5 * test::kDegree;
using features::kStraightness;  // what no average removes
const egraph::LandmarkId kLandmark{3};

/// One frame that sees one direction of the world; owns what DirectionViews points to.
struct View {
  std::vector<DirectionFeature> directions;
  std::vector<egraph::Association> associations;
  Matrix3d world_from_camera;
  Matrix3d rotation_covariance = Matrix3d::Zero();

  [[nodiscard]] DirectionViews views() const {
    return {directions, associations, world_from_camera, rotation_covariance};
  }
};

/// The frame's rotation is exact; its signs are the sensor's, as vanishing directions have any.
View view_of(const Vector3d& in_world, double noise, double sign, base::Random& random,
             DirectionKind kind = DirectionKind::vanishing_direction) {
  View view;
  view.world_from_camera = test::random_rotation(random);
  const Vector3d in_camera =
      test::disturbed_direction(sign * (view.world_from_camera.transpose() * in_world), noise, random);
  view.directions.push_back({.kind = kind,
                             .direction = in_camera,
                             .covariance = test::tangential_covariance(in_camera, noise),
                             .support = 3,
                             .source = -1});
  view.associations.push_back({.feature = 0, .landmark = kLandmark, .sign = sign, .chi2 = 0, .outlier_chi2 = 0});
  return view;
}

double sigma_of(const DirectionFeature& direction) { return std::sqrt(0.5 * direction.covariance.trace()); }

double chi2(const DirectionFeature& direction, const Vector3d& truth) {
  const Eigen::Matrix<double, 3, 2> basis = geometry::tangent_basis(direction.direction);
  const Eigen::Vector2d error = basis.transpose() * (truth.dot(direction.direction) < 0 ? Vector3d(-truth) : truth);
  const Eigen::Matrix2d covariance = basis.transpose() * direction.covariance * basis;
  return error.dot(covariance.inverse() * error);
}

TEST(DirectionTracks, AverageTheNoiseOfFramesWhateverTheirSigns) {
  base::Random random(1);
  const Vector3d truth = test::random_direction(random);
  constexpr int kFrames = 15;
  double chi2_sum = 0.0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    DirectionTracks tracks;
    for (int frame = 0; frame < kFrames; ++frame) {
      tracks.add(view_of(truth, kNoise, frame % 2 == 0 ? 1.0 : -1.0, random).views());
    }
    const View keyframe = view_of(truth, kNoise, -1.0, random);
    const AssociatedDirections fused = tracks.fuse(keyframe.views());
    ASSERT_EQ(fused.directions.size(), 1U);
    const DirectionFeature& direction = fused.directions[0];
    EXPECT_GT(direction.direction.dot(keyframe.directions[0].direction), 0.9) << "the sign of the keyframe's own stays";
    EXPECT_LT((direction.covariance * direction.direction).norm(), 1e-12) << "tangential";
    EXPECT_NEAR(sigma_of(direction), std::hypot(kNoise / std::sqrt(kFrames + 1.0), kStraightness), 0.02 * kNoise);
    chi2_sum += chi2(direction, keyframe.world_from_camera.transpose() * truth);
  }
  // chi²(2), less the floor for what edges are straight to, which these measurements do not have.
  const double averaged = kNoise * kNoise / (kFrames + 1.0);
  EXPECT_NEAR(chi2_sum / kTrials, 2.0 * averaged / (averaged + kStraightness * kStraightness), 0.25);
}

TEST(DirectionTracks, TellAKeyframeWhatItDoesNotSee) {
  base::Random random(2);
  const Vector3d truth = test::random_direction(random);
  DirectionTracks tracks;
  for (int frame = 0; frame < 9; ++frame) tracks.add(view_of(truth, kNoise, 1.0, random).views());
  View keyframe = view_of(test::random_direction(random), kNoise, 1.0, random);
  keyframe.associations[0].landmark = egraph::LandmarkId{7};
  const AssociatedDirections fused = tracks.fuse(keyframe.views());
  ASSERT_EQ(fused.directions.size(), 2U);
  ASSERT_EQ(fused.associations.size(), 2U);
  EXPECT_EQ(fused.directions[0].direction, keyframe.directions[0].direction) << "it has no track";
  EXPECT_EQ(fused.associations[1].landmark, kLandmark);
  EXPECT_EQ(fused.associations[1].feature, 1U);
  EXPECT_EQ(fused.directions[1].source, -1);
  const Vector3d seen = keyframe.world_from_camera * fused.directions[1].direction;
  EXPECT_LT(geometry::axial_angle(seen, truth), 4.0 * kNoise / 3.0);
  EXPECT_GT(seen.dot(truth), 0.0) << "the landmark's sign";
  tracks.clear();
  EXPECT_EQ(tracks.fuse(keyframe.views()).directions.size(), 1U);
}

TEST(DirectionTracks, TheTurnBetweenTheFramesDoesNotAverageOut) {
  base::Random random(3);
  const Vector3d truth = test::random_direction(random);
  constexpr double kTurn = 0.3 * test::kDegree;
  DirectionTracks tracks;
  for (int frame = 0; frame < 100; ++frame) {
    View view = view_of(truth, kNoise, 1.0, random);
    view.rotation_covariance = kTurn * kTurn * Matrix3d::Identity();
    tracks.add(view.views());
  }
  View keyframe = view_of(truth, kNoise, 1.0, random);
  keyframe.associations[0].landmark = egraph::LandmarkId{7};
  keyframe.rotation_covariance = kTurn * kTurn * Matrix3d::Identity();
  const double expected = std::sqrt(2.0 * kTurn * kTurn + kNoise * kNoise / 100.0 + kStraightness * kStraightness);
  EXPECT_NEAR(sigma_of(tracks.fuse(keyframe.views()).directions[1]), expected, 0.02 * expected);
}

TEST(DirectionTracks, NormalsOfPlanesAreLeftAlone) {
  base::Random random(4);
  const Vector3d truth = test::random_direction(random);
  DirectionTracks tracks;
  for (int frame = 0; frame < 9; ++frame) {
    tracks.add(view_of(truth, kNoise, 1.0, random, DirectionKind::plane_normal).views());
  }
  const View keyframe = view_of(truth, kNoise, 1.0, random, DirectionKind::plane_normal);
  const AssociatedDirections fused = tracks.fuse(keyframe.views());
  ASSERT_EQ(fused.directions.size(), 1U);
  EXPECT_EQ(fused.directions[0].direction, keyframe.directions[0].direction);
  EXPECT_EQ(fused.directions[0].covariance, keyframe.directions[0].covariance);
}

TEST(DirectionTracks, ATrackIsToldOnce) {
  base::Random random(5);
  const Vector3d truth = test::random_direction(random);
  DirectionTracks tracks;
  for (int frame = 0; frame < 9; ++frame) tracks.add(view_of(truth, kNoise, 1.0, random).views());
  View keyframe = view_of(truth, kNoise, 1.0, random);
  keyframe.directions.push_back(keyframe.directions[0]);  // a group of lines and a single one, of one landmark
  keyframe.associations.push_back(keyframe.associations[0]);
  keyframe.associations[1].feature = 1;
  const AssociatedDirections fused = tracks.fuse(keyframe.views());
  ASSERT_EQ(fused.directions.size(), 2U);
  EXPECT_LT(sigma_of(fused.directions[0]), 0.5 * kNoise);
  EXPECT_EQ(fused.directions[1].covariance, keyframe.directions[1].covariance);
}

TEST(DirectionTracks, FollowAMapThatTurns) {
  base::Random random(6);
  const Vector3d truth = test::random_direction(random);
  const Matrix3d turn = geometry::so3_exp({0.02, -0.01, 0.03});
  DirectionTracks tracks;
  for (int frame = 0; frame < 4; ++frame) tracks.add(view_of(truth, 0.0, 1.0, random).views());
  tracks.turn(turn);
  View keyframe = view_of(truth, 0.0, 1.0, random);
  keyframe.world_from_camera = turn * keyframe.world_from_camera;
  const Vector3d own = keyframe.directions[0].direction;
  keyframe.associations[0].landmark = egraph::LandmarkId{7};
  EXPECT_LT(geometry::axial_angle(tracks.fuse(keyframe.views()).directions[1].direction, own), 1e-6);
}

}  // namespace
}  // namespace eg::tracking
