#include "common/egraph/association.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_geometry.hpp"

namespace eg::egraph {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using features::DirectionFeature;
using test::kDegree;
using test::tangential_covariance;

constexpr double kSigma = 0.02;

DirectionFeature feature(const Vector3d& direction, DirectionKind kind = DirectionKind::vanishing_direction,
                         double sigma = kSigma) {
  return {kind, direction, tangential_covariance(direction, sigma), 3, -1};
}

DirectionLandmark landmark(int id, const Vector3d& direction, DirectionKind kind = DirectionKind::vanishing_direction,
                           double sigma = kSigma) {
  return {LandmarkId{id}, kind, direction, tangential_covariance(direction, sigma), 1, KeyframeId{0}, KeyframeId{0}};
}

Vector3d tilted(double degrees) { return {std::sin(degrees * kDegree), 0, std::cos(degrees * kDegree)}; }

Graph graph_of(const std::vector<DirectionLandmark>& landmarks) {
  GraphSnapshot snapshot;
  snapshot.landmarks = landmarks;
  Graph graph;
  EXPECT_TRUE(graph.reset(snapshot));
  return graph;
}

std::vector<Association> associate_in_world(const std::vector<DirectionFeature>& features,
                                            const std::vector<DirectionLandmark>& landmarks,
                                            const AssociationOptions& options = {}) {
  return associate(features, graph_of(landmarks), Matrix3d::Identity(), Matrix3d::Zero(), options);
}

TEST(Association, AVagueOrCrowdedMatchProvesLittle) {
  const auto worth = [](double sigma, const std::vector<DirectionLandmark>& landmarks) {
    return associate_in_world({feature(Vector3d::UnitZ(), DirectionKind::vanishing_direction, sigma)}, landmarks)
        .at(0)
        .outlier_chi2;
  };
  const std::vector<DirectionLandmark> alone = {
      landmark(0, Vector3d::UnitZ(), DirectionKind::vanishing_direction, 0.0)};
  std::vector<DirectionLandmark> crowd = alone;
  for (int id = 1; id < 4; ++id) crowd.push_back(landmark(id, tilted(id)));
  // A gate of radius 0.087 against an ellipse of 2π 0.001²; four candidates are four chances.
  EXPECT_NEAR(worth(0.001, alone), 2.0 * std::log(0.087 * 0.087 / (2.0 * 0.001 * 0.001)), 0.1);
  EXPECT_NEAR(worth(0.001, alone) - worth(0.001, crowd), 2.0 * std::log(4.0), 1e-9);
  EXPECT_LT(worth(0.02, alone), worth(0.001, alone) - 10.0);
  EXPECT_EQ(worth(0.2, crowd), 0.0);
}

TEST(Association, RotatesIntoTheWorldAndUnifiesTheSign) {
  base::Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Matrix3d world_from_camera = test::random_rotation(random);
    const std::vector<DirectionLandmark> landmarks = {landmark(4, Vector3d::UnitX()), landmark(7, Vector3d::UnitY()),
                                                      landmark(9, Vector3d::UnitZ())};
    const Matrix3d camera_from_world = world_from_camera.transpose();
    const std::vector<DirectionFeature> features = {feature(-camera_from_world.col(2)),
                                                    feature(camera_from_world.col(0))};
    const auto found = associate(features, graph_of(landmarks), world_from_camera, Matrix3d::Zero());
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].feature, 0U);
    EXPECT_EQ(found[0].landmark, LandmarkId{9});
    EXPECT_EQ(found[0].sign, -1.0) << "the paper's equation 8";
    EXPECT_EQ(found[1].feature, 1U);
    EXPECT_EQ(found[1].landmark, LandmarkId{4});
    EXPECT_EQ(found[1].sign, 1.0);
  }
}

TEST(Association, KindsDoNotMix) {
  using enum DirectionKind;
  const auto joined = [](DirectionKind seen, DirectionKind known) {
    return associate(feature(Vector3d::UnitZ(), seen), std::vector{landmark(0, Vector3d::UnitZ(), known)},
                     Matrix3d::Identity(), Matrix3d::Zero())
        .has_value();
  };
  EXPECT_TRUE(joined(plane_normal, plane_normal));
  EXPECT_TRUE(joined(vanishing_direction, vanishing_direction));
  EXPECT_TRUE(joined(vanishing_direction, potential_direction));
  EXPECT_TRUE(joined(potential_direction, vanishing_direction));
  EXPECT_TRUE(joined(potential_direction, potential_direction));
  EXPECT_FALSE(joined(plane_normal, vanishing_direction));
  EXPECT_FALSE(joined(plane_normal, potential_direction));
  EXPECT_FALSE(joined(vanishing_direction, plane_normal));
  EXPECT_FALSE(joined(potential_direction, plane_normal));
}

TEST(Association, APotentialDirectionOfTheGraphProvesNothing) {
  const std::vector<DirectionLandmark> known = {landmark(0, tilted(0), DirectionKind::potential_direction),
                                                landmark(1, tilted(2.0))};
  const auto found = associate_in_world({feature(tilted(0))}, known);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].landmark, LandmarkId{1});
}

TEST(Association, NoCovarianceExcusesMoreThanTheMaximumAngle) {
  const AssociationOptions options{.max_angle = 5.0 * kDegree, .max_chi2 = 1e6};
  EXPECT_EQ(associate_in_world({feature(tilted(4.9))}, {landmark(0, tilted(0))}, options).size(), 1U);
  EXPECT_EQ(associate_in_world({feature(tilted(5.1))}, {landmark(0, tilted(0))}, options).size(), 0U);
}

TEST(Association, CovarianceGateIsTheDifferenceInStandardDeviations) {
  // Feature and landmark have sigma each: their difference sqrt(2) sigma. The gate is sqrt(13.82) = 3.72 of those.
  const double sigma = 0.005;
  const double limit = std::sqrt(13.82 * (2.0 * sigma * sigma + 3e-8));
  const auto seen_at = [&](double sine) {
    const Vector3d direction(sine, 0, std::sqrt(1 - sine * sine));
    return associate_in_world({feature(direction, DirectionKind::vanishing_direction, sigma)},
                              {landmark(0, tilted(0), DirectionKind::vanishing_direction, sigma)});
  };
  EXPECT_EQ(seen_at(0.999 * limit).size(), 1U);
  EXPECT_EQ(seen_at(1.001 * limit).size(), 0U);
}

TEST(Association, UncertainRotationOpensTheGateAcrossTheDirectionOnly) {
  const std::vector<DirectionFeature> seen = {feature(tilted(4.0), DirectionKind::vanishing_direction, 0.001)};
  const std::vector<DirectionLandmark> known = {
      landmark(0, tilted(0), DirectionKind::vanishing_direction, 0.001)};  // turned about y
  const auto with = [&](const Vector3d& sigmas) {
    return associate(seen, graph_of(known), Matrix3d::Identity(), sigmas.cwiseAbs2().asDiagonal()).size();
  };
  EXPECT_EQ(with({0, 0, 0}), 0U);
  EXPECT_EQ(with({0, 0.05, 0}), 1U) << "an unknown turn about y explains it";
  EXPECT_EQ(with({0.05, 0, 0}), 0U) << "one about x moves the direction the other way";
  EXPECT_EQ(with({0, 0, 0.05}), 0U) << "one about the direction itself does not move it";
}

TEST(Association, TakesTheBestLandmarkAndAllowsSeveralViewsOfIt) {
  const std::vector<DirectionLandmark> landmarks = {landmark(0, tilted(-2.0)), landmark(1, tilted(1.0))};
  const auto found = associate_in_world({feature(tilted(0.0)), feature(tilted(0.8)), feature(tilted(-1.9))}, landmarks);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].landmark, LandmarkId{1});
  EXPECT_EQ(found[1].landmark, LandmarkId{1}) << "parallel walls have one normal";
  EXPECT_EQ(found[2].landmark, LandmarkId{0});
}

TEST(Association, WeighsByCovarianceWhichLandmarkIsNearest) {
  // One degree from a certain landmark is further than two from an uncertain one.
  const std::vector<DirectionLandmark> landmarks = {
      landmark(0, tilted(-1.0), DirectionKind::vanishing_direction, 0.0001),
      landmark(1, tilted(2.0), DirectionKind::vanishing_direction, 0.05)};
  const auto found = associate_in_world({feature(tilted(0), DirectionKind::vanishing_direction, 0.005)}, landmarks);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].landmark, LandmarkId{1});
}

TEST(Association, OfExactDataIsNotRejectedForRounding) {
  const Matrix3d turn = geometry::so3_exp({0.1, 0.7, -2.0});
  const auto found =
      associate(std::vector{feature(turn.transpose() * tilted(30), DirectionKind::plane_normal, 0.0)},
                graph_of({landmark(0, tilted(30), DirectionKind::plane_normal, 0.0)}), turn, Matrix3d::Zero());
  EXPECT_EQ(found.size(), 1U);
}

TEST(Association, OfNothing) {
  EXPECT_TRUE(associate_in_world({}, {landmark(0, tilted(0))}).empty());
  EXPECT_TRUE(associate_in_world({feature(tilted(0))}, {}).empty());
}

TEST(Association, DirectionCovarianceInWorldMatchesSamples) {
  base::Random random(2);
  const Matrix3d world_from_camera = test::random_rotation(random);
  const Vector3d direction = test::random_direction(random);
  const Vector3d rotation_sigmas(0.01, 0.03, 0.02);
  const Matrix3d predicted =
      direction_covariance_in_world(feature(direction), world_from_camera, rotation_sigmas.cwiseAbs2().asDiagonal());
  Matrix3d sampled = Matrix3d::Zero();
  constexpr int kSamples = 20'000;
  for (int i = 0; i < kSamples; ++i) {
    const Vector3d turn(rotation_sigmas.x() * random.normal(), rotation_sigmas.y() * random.normal(),
                        rotation_sigmas.z() * random.normal());
    const Vector3d seen =
        geometry::so3_exp(turn) * world_from_camera * test::disturbed_direction(direction, kSigma, random);
    const Vector3d error = seen - world_from_camera * direction;
    sampled += error * error.transpose() / kSamples;
  }
  EXPECT_LT((sampled - predicted).norm(), 0.05 * predicted.norm());
  EXPECT_NEAR((predicted * (world_from_camera * direction)).norm(), 0.0, 1e-12) << "tangential";
}

}  // namespace
}  // namespace eg::egraph
