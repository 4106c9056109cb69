#include "common/eval/mesh_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>

namespace eg::eval {
namespace {

/// Samples as nanoflann wants to see them.
struct SampleCloud {
  const std::vector<SurfaceSample>& samples;

  [[nodiscard]] std::size_t kdtree_get_point_count() const { return samples.size(); }
  [[nodiscard]] float kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return samples[index].point[static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, SampleCloud>, SampleCloud, 3>;

/// Finds the distance to a surface: the nearest samples tell which triangles to look at.
class SurfaceIndex {
 public:
  SurfaceIndex(const SurfaceView& surface, const SurfaceSamples& samples)
      : surface_(surface), samples_(samples), cloud_{samples.samples}, tree_(3, cloud_) {}

  [[nodiscard]] double distance_from(const Eigen::Vector3f& point) const {
    // A few, because the nearest triangle's own sample need not be the nearest sample of all.
    constexpr std::size_t kCandidates = 8;
    std::array<std::uint32_t, kCandidates> nearest{};
    std::array<float, kCandidates> squared{};
    const std::size_t found = tree_.knnSearch(point.data(), kCandidates, nearest.data(), squared.data());
    if (samples_.triangle.empty()) return std::sqrt(squared[0]);
    float distance = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < found; ++i) {
      const auto& [a, b, c] = surface_.triangles[samples_.triangle[nearest[i]]];
      distance = std::min(
          distance, distance_to_triangle(point, surface_.vertices[a], surface_.vertices[b], surface_.vertices[c]));
    }
    return distance;
  }

 private:
  const SurfaceView& surface_;
  const SurfaceSamples& samples_;
  SampleCloud cloud_;
  Tree tree_;
};

SurfaceDistances distances(const SurfaceSamples& from, const SurfaceIndex& to) {
  std::vector<WeightedError> errors;
  for (const SurfaceSample& sample : from.samples) errors.push_back({to.distance_from(sample.point), sample.area});
  SurfaceDistances result;
  result.share_within_1cm = share_within(errors, 0.01);
  result.share_within_5cm = share_within(errors, 0.05);
  result.distance_m = statistics_of(std::move(errors));
  return result;
}

}  // namespace

base::Result<MeshErrors> evaluate_mesh(const SurfaceView& estimate, const SurfaceView& reference,
                                       const MeshErrorOptions& options) {
  const SurfaceSamples estimate_samples = sample_surface(estimate, options.spacing_m);
  const SurfaceSamples reference_samples = sample_surface(reference, options.spacing_m);
  if (estimate_samples.samples.empty()) return base::fail("the estimated mesh has no surface");
  if (reference_samples.samples.empty()) return base::fail("the reference mesh has no surface");
  const SurfaceIndex estimate_index(estimate, estimate_samples);
  const SurfaceIndex reference_index(reference, reference_samples);
  return MeshErrors{distances(estimate_samples, reference_index), distances(reference_samples, estimate_index)};
}

}  // namespace eg::eval
