// What keyframes say about where they stand relative to each other: pose_covariance.hpp, relative_poses.hpp.
#include "common/tracking/relative_poses.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "common/egraph/graph_optimizer.hpp"
#include "common/tracking/pose_covariance.hpp"
#include "tests/unit/tracking/hand_made_frames.hpp"
#include "tests/unit/tracking/tracker_loop.hpp"

namespace eg::tracking {
namespace {

using egraph::Matrix6d;
using egraph::RelativePose;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kTurnSigma = 0.05 * kDegree;
constexpr double kTurn = 2.0 * kTurnSigma;
const Vector3d kFar(80.0, -3.0, 60.0);

/// The covariance (world frame) of a pose whose errors in its own axes are independent: rotation, translation.
Matrix6d covariance_in_world(const Pose& world_from_camera, double rotation_sigma, double translation_sigma) {
  Vector6d variances;
  variances << Vector3d::Constant(rotation_sigma * rotation_sigma),
      Vector3d::Constant(translation_sigma * translation_sigma);
  const Matrix6d to_world = adjoint(world_from_camera);
  return to_world * variances.asDiagonal() * to_world.transpose();
}

/// The covariance of where the camera's centre is, given that of a left perturbation of its pose.
Eigen::Matrix3d covariance_of_centre(const Matrix6d& covariance, const Pose& world_from_camera) {
  Eigen::Matrix<double, 3, 6> by_perturbation;
  by_perturbation << -geometry::hat(world_from_camera.translation), Eigen::Matrix3d::Identity();
  return by_perturbation * covariance * by_perturbation.transpose();
}

TEST(PoseCovariance, TheAdjointTakesPerturbationsThroughAPose) {
  base::Random random(1);
  const Pose a = test::random_pose(random);
  const Pose b = test::random_pose(random);
  const Vector6d step = 1e-6 * Vector6d::LinSpaced(-1.0, 1.0);
  const Vector6d same = adjoint(a) * step;
  const Pose moved = a * perturb(b, step);
  const Pose expected = perturb(a * b, same);
  EXPECT_LT((moved.rotation - expected.rotation).norm(), 1e-10);
  EXPECT_LT((moved.translation - expected.translation).norm(), 1e-10);
}

TEST(PoseCovariance, TurnsOfACameraLeaveItWhereItIs) {
  base::Random random(2);
  const Pose pose{test::random_rotation(random), kFar};
  const Matrix6d before = covariance_in_world(pose, 0.1 * kTurnSigma, 0.002);
  const Matrix6d after = with_turns_of_camera(before, pose, kTurnSigma * kTurnSigma);
  EXPECT_LT((covariance_of_centre(after, pose) - covariance_of_centre(before, pose)).norm(), 1e-9);
  const Eigen::Matrix3d added = (after - before).topLeftCorner<3, 3>();
  EXPECT_LT((added - kTurnSigma * kTurnSigma * Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

/// `keyframes` at equal steps from `first` on that all see the same five points.
Map row_of_keyframes(const Pose& first, int keyframes) {
  std::vector<PointFeature> points;
  for (int i = 0; i < 5; ++i) points.push_back(point_at({100.0 + 80.0 * i, 240.0}, with_bits(16, 24 * i)));
  Map map;
  for (int k = 0; k < keyframes; ++k) {
    Matches seen;
    for (int i = 0; k > 0 && i < 5; ++i) seen.points.push_back({i, PointId{i}});
    map.add_keyframe(frame_of(points), first * Pose{Eigen::Matrix3d::Identity(), {0.4 * k, 0.0, 0.0}}, seen);
  }
  return map;
}

TEST(RelativePoses, TogetherKnowWhatThePoseKnowsAndNoMore) {
  base::Random random(3);
  const Map map = row_of_keyframes({test::random_rotation(random), kFar}, 5);
  const Pose& pose = map.keyframes().back().world_from_camera;
  const Matrix6d covariance = covariance_in_world(pose, kTurnSigma, 0.003);
  const std::vector<RelativePose> relative = relative_poses(map, map.keyframes().back().id, covariance);
  ASSERT_EQ(relative.size(), 4U);
  Matrix6d information = Matrix6d::Zero();  // in the camera's own axes
  for (const RelativePose& edge : relative) {
    const Matrix6d to_camera = adjoint(edge.first_from_second.inverse());
    information += (to_camera * edge.covariance * to_camera.transpose()).inverse();
  }
  const Matrix6d to_camera = adjoint(pose.inverse());
  const Matrix6d in_camera = to_camera * covariance * to_camera.transpose();
  EXPECT_LT((information * in_camera - Matrix6d::Identity()).norm(), 1e-3);
}

/// A graph of a row of keyframes, whose relative poses are as the tracker makes them; all see the same two directions,
/// which the younger half sees as if it had turned by kTurn.
egraph::Graph half_turned_row(const Map& map) {
  const auto keyframes = static_cast<std::int32_t>(map.keyframes().size());
  egraph::GraphSnapshot graph;
  graph.version = keyframes;
  const auto tangential = [](const Vector3d& direction, double sigma) {
    return test::tangential_covariance(direction, sigma);
  };
  const std::array<Vector3d, 2> directions = {Vector3d::UnitX(), Vector3d::UnitY()};
  for (int l = 0; l < 2; ++l) {
    const Vector3d& direction = directions[static_cast<std::size_t>(l)];
    graph.landmarks.push_back({egraph::LandmarkId{l}, egraph::DirectionKind::plane_normal, direction,
                               tangential(direction, kTurnSigma), keyframes, KeyframeId{0}, KeyframeId{keyframes - 1}});
  }
  for (const MapKeyframe& keyframe : map.keyframes()) {
    const Pose& pose = keyframe.world_from_camera;
    const bool turned = 2 * keyframe.id.value >= keyframes;
    const Eigen::Matrix3d seen_from = geometry::so3_exp({0.0, 0.0, turned ? kTurn : 0.0}) * pose.rotation;
    graph.keyframes.push_back({keyframe.id, keyframe.id.value, 1000 * keyframe.id.value, pose, Matrix6d::Identity()});
    for (int l = 0; l < 2; ++l) {
      const Vector3d seen = seen_from.transpose() * directions[static_cast<std::size_t>(l)];
      graph.observations.push_back({keyframe.id, egraph::LandmarkId{l}, seen, tangential(seen, 0.01 * kTurnSigma)});
    }
    const Matrix6d covariance =
        with_turns_of_camera(covariance_in_world(pose, 0.01 * kTurnSigma, 0.001), pose, kTurnSigma * kTurnSigma);
    for (const RelativePose& edge : relative_poses(map, keyframe.id, covariance)) graph.relative_poses.push_back(edge);
  }
  egraph::Graph made;
  EXPECT_TRUE(made.reset(graph).has_value());
  return made;
}

TEST(RelativePoses, AKeyframeThatTurnsStaysWhereItIsHoweverFarFromTheOrigin) {
  for (const Vector3d& place : {Vector3d(0.0, 0.0, 0.0), kFar}) {
    const Map map = row_of_keyframes({Eigen::Matrix3d::Identity(), place}, 2);
    egraph::Graph graph = half_turned_row(map);
    const egraph::GraphCorrections corrections = egraph::optimize_graph(graph, {.min_direction_sigma = 1e-5});
    ASSERT_EQ(corrections.keyframes.size(), 1U);
    const Pose& before = map.keyframes()[1].world_from_camera;
    const Pose& after = corrections.keyframes[0].world_from_camera;
    EXPECT_GT(geometry::rotation_angle_between(before.rotation, after.rotation), 0.9 * kTurn) << place.transpose();
    EXPECT_LT((after.translation - before.translation).norm(), 0.001) << place.transpose();
  }
}

TEST(RelativePoses, DoNotCountTheDirectionsThatTheGraphCountsItself) {
  const geometry::CameraModel camera = *geometry::find_camera("tum_fr3");
  FeatureSequence sequence = test::record(test::make_room(oblique_room()), camera, walk_around(camera, 240), 1);
  const auto run_with = [&](double sigma) {
    SlamLoop slam;
    for (FrameFeatures frame : std::span(sequence.frames).first(40)) {
      for (auto& seen : frame.directions) seen.covariance = test::tangential_covariance(seen.direction, sigma);
      EXPECT_TRUE(slam.step(frame).has_pose);
    }
    return slam.keyframes();
  };
  const auto rotation_variance = [](const Matrix6d& covariance) { return covariance.topLeftCorner<3, 3>().trace(); };
  const std::vector<egraph::Keyframe> vague = run_with(1.0 * kDegree);
  const std::vector<egraph::Keyframe> sharp = run_with(0.01 * kDegree);
  ASSERT_GE(std::min(vague.size(), sharp.size()), 2U);
  ASSERT_FALSE(vague[1].relative_poses.empty());
  ASSERT_FALSE(sharp[1].relative_poses.empty());
  EXPECT_LT(rotation_variance(sharp[1].covariance), 0.8 * rotation_variance(vague[1].covariance));
  EXPECT_GT(rotation_variance(sharp[1].relative_poses[0].covariance),
            0.95 * rotation_variance(vague[1].relative_poses[0].covariance));
}

}  // namespace
}  // namespace eg::tracking
