#include "common/eval/mesh_errors.hpp"

#include <gtest/gtest.h>

#include "common/base/random.hpp"

namespace eg::eval {
namespace {

using Eigen::Vector3f;
using Triangle = std::array<std::uint32_t, 3>;

struct Surface {
  std::vector<Vector3f> vertices;
  std::vector<Triangle> triangles;
  [[nodiscard]] SurfaceView view() const { return {vertices, triangles}; }
};

/// A rectangle in the plane of height z, as two triangles.
Surface sheet(float width, float depth, float z) {
  return {{{0, 0, z}, {width, 0, z}, {width, depth, z}, {0, depth, z}}, {{0, 1, 2}, {0, 2, 3}}};
}

TEST(SampleSurface, CoversTheAreaEvenly) {
  const SurfaceSamples samples = sample_surface(sheet(1.0F, 0.5F, 0.0F).view(), 0.05);
  double area = 0.0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const SurfaceSample& sample : samples.samples) {
    area += sample.area;
    centre += sample.area * sample.point.cast<double>();
  }
  EXPECT_NEAR(area, 0.5, 1e-6);
  EXPECT_NEAR((centre / area - Eigen::Vector3d(0.5, 0.25, 0)).norm(), 0.0, 1e-6);
  EXPECT_EQ(samples.samples.size(), samples.triangle.size());
  EXPECT_GE(samples.samples.size(), 400U);
}

TEST(SampleSurface, AVertexGoneAstrayTakesBoundedMemory) {
  const Surface stray{{{0, 0, 0}, {1, 0, 0}, {0, 1e10F, 0}}, {{0, 1, 2}}};
  const SurfaceSamples samples = sample_surface(stray.view(), 0.02);
  EXPECT_EQ(samples.samples.size(), 1'000'000U);
  EXPECT_NEAR(samples.samples.front().area, 5e3F, 1.0F);
}

TEST(SampleSurface, TrianglesWithoutAreaGiveNothing) {
  const Surface needle{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 0, 0}}};
  EXPECT_TRUE(sample_surface(needle.view(), 0.1).samples.empty());
}

TEST(DistanceToTriangle, EveryRegion) {
  const Vector3f a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  const auto distance = [&](float x, float y, float z) { return distance_to_triangle({x, y, z}, a, b, c); };
  EXPECT_FLOAT_EQ(distance(1, 1, 0), 0);                // on the face
  EXPECT_FLOAT_EQ(distance(1, 1, -3), 3);               // below the face
  EXPECT_FLOAT_EQ(distance(-3, -4, 0), 5);              // corner a
  EXPECT_FLOAT_EQ(distance(7, -4, 0), 5);               // corner b
  EXPECT_FLOAT_EQ(distance(-4, 7, 0), 5);               // corner c
  EXPECT_FLOAT_EQ(distance(2, -3, 4), 5);               // edge ab
  EXPECT_FLOAT_EQ(distance(-3, 2, 4), 5);               // edge ac
  EXPECT_FLOAT_EQ(distance(3, 3, 0), std::sqrt(2.0F));  // edge bc
}

TEST(DistanceToTriangle, IsNoMoreThanToAnyOfItsPoints) {
  base::Random random(8);
  const auto point = [&] {
    return Vector3f(static_cast<float>(random.normal()), static_cast<float>(random.normal()),
                    static_cast<float>(random.normal()));
  };
  for (int round = 0; round < 200; ++round) {
    const Vector3f a = point(), b = point(), c = point(), p = point();
    float nearest = 1e9F;
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const float u = static_cast<float>(i) / kSteps, v = static_cast<float>(j) / kSteps;
        nearest = std::min(nearest, (a + u * (b - a) + v * (c - a) - p).norm());
      }
    }
    const float distance = distance_to_triangle(p, a, b, c);
    EXPECT_LE(distance, nearest + 1e-5F);
    EXPECT_GE(distance, nearest - 0.1F);
  }
}

TEST(MeshErrors, AnIdenticalMeshHasNone) {
  const Surface surface = sheet(1, 1, 0);
  const auto errors = evaluate_mesh(surface.view(), surface.view());
  ASSERT_TRUE(errors.has_value());
  EXPECT_LT(errors->accuracy.distance_m.max, 1e-6);
  EXPECT_LT(errors->completeness.distance_m.max, 1e-6);
  EXPECT_DOUBLE_EQ(errors->accuracy.share_within_1cm, 1.0);
}

TEST(MeshErrors, AnOffsetIsMeasuredExactlyWhateverTheTriangulation) {
  // 3 cm above; the reference is much more finely cut than the estimate.
  Surface reference;
  for (int i = 0; i < 50; ++i) {
    const auto base = static_cast<std::uint32_t>(reference.vertices.size());
    const float x = 0.02F * static_cast<float>(i);
    for (const Vector3f& v :
         {Vector3f(x, 0, 0), Vector3f(x + 0.02F, 0, 0), Vector3f(x + 0.02F, 1, 0), Vector3f(x, 1, 0)}) {
      reference.vertices.push_back(v);
    }
    reference.triangles.push_back({base, base + 1, base + 2});
    reference.triangles.push_back({base, base + 2, base + 3});
  }
  const auto errors = evaluate_mesh(sheet(1, 1, 0.03F).view(), reference.view());
  ASSERT_TRUE(errors.has_value());
  for (const SurfaceDistances& distances : {errors->accuracy, errors->completeness}) {
    EXPECT_NEAR(distances.distance_m.mean, 0.03, 1e-5);
    EXPECT_NEAR(distances.distance_m.max, 0.03, 1e-4);
    EXPECT_EQ(distances.share_within_1cm, 0.0);
    EXPECT_NEAR(distances.share_within_5cm, 1.0, 1e-9);
  }
}

TEST(MeshErrors, AMissingHalfLowersCompletenessOnly) {
  const auto errors = evaluate_mesh(sheet(1, 1, 0).view(), sheet(2, 1, 0).view());
  ASSERT_TRUE(errors.has_value());
  EXPECT_LT(errors->accuracy.distance_m.max, 1e-6);
  EXPECT_NEAR(errors->completeness.share_within_1cm, 0.505, 0.003);
  EXPECT_NEAR(errors->completeness.distance_m.max, 1.0, 0.02);
  EXPECT_NEAR(errors->completeness.distance_m.mean, 0.25, 0.003);  // half at 0, half on average 0.5 m away
}

TEST(MeshErrors, AreaWeighsNotTriangles) {
  // 99 % of the area is exact, one small piece of many triangles is 1 m off.
  Surface estimate = sheet(1, 1, 0);
  for (int i = 0; i < 100; ++i) {
    const auto base = static_cast<std::uint32_t>(estimate.vertices.size());
    const float x = 0.01F * static_cast<float>(i);
    for (const Vector3f& v : {Vector3f(x, 0, 1), Vector3f(x + 0.01F, 0, 1), Vector3f(x, 0.02F, 1)}) {
      estimate.vertices.push_back(v);
    }
    estimate.triangles.push_back({base, base + 1, base + 2});
  }
  const auto errors = evaluate_mesh(estimate.view(), sheet(1, 1, 0).view());
  EXPECT_NEAR(errors->accuracy.share_within_1cm, 1.0 / 1.01, 1e-4);
}

TEST(MeshErrors, CloudsAreComparedByPoints) {
  const std::vector<Vector3f> cloud = {{0, 0, 0}, {1, 0, 0}}, other = {{0, 0, 0.02F}, {1, 0, 0.04F}, {1, 0, 9}};
  const auto errors = evaluate_mesh({cloud}, {other});
  ASSERT_TRUE(errors.has_value());
  EXPECT_NEAR(errors->accuracy.distance_m.mean, 0.03, 1e-6);
  EXPECT_NEAR(errors->completeness.distance_m.max, 9.0, 1e-5);
}

TEST(MeshErrors, NothingToCompareIsAnError) {
  const Surface surface = sheet(1, 1, 0);
  EXPECT_EQ(evaluate_mesh({}, surface.view()).error().message, "the estimated mesh has no surface");
  EXPECT_EQ(evaluate_mesh(surface.view(), {}).error().message, "the reference mesh has no surface");
}

}  // namespace
}  // namespace eg::eval
