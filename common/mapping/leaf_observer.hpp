#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "common/geometry/pose.hpp"
#include "common/image/rgbd_frame.hpp"
#include "common/mapping/depth_view.hpp"
#include "common/mapping/tsdf_grids.hpp"
#include "common/mapping/vector4.hpp"

namespace eg::mapping {

/// What a frame says about the voxels of a leaf, in OpenVDB's order.
struct LeafReading {
  static constexpr int kGroups = kLeafVoxels / 4;  ///< of four voxels, neighbours along z

  std::array<Int4, kGroups> weight;    ///< 0: nothing
  std::array<Int4, kGroups> distance;  ///< in TsdfUnits::metres_per_step(); cut off in free space
  std::array<Int4, kGroups> pixel;     ///< number of the pixel that shows its colour; -1 far from the surface
  bool has_colour;                     ///< whether any voxel has a pixel
};

/// Looks the voxels of leaves up in one frame.
class LeafObserver {
 public:
  LeafObserver(const image::RectifiedFrame& frame, const geometry::Pose& world_from_camera, const TsdfOptions& options);

  [[nodiscard]] const DepthView& view() const { return view_; }

  /// What there is to be seen of a leaf.
  enum class Sight : std::uint8_t {
    nothing,  ///< it is out of sight, behind the surfaces or in free space
    plain,    ///< it lies inside the image, where every pixel has a reading and no depth edge is near
    mixed,
  };
  /// A linear function of a voxel's number in its leaf.
  struct Linear {
    float at_first = 0.0F;
    Eigen::Vector3f steps = Eigen::Vector3f::Zero();  ///< to the next voxel along x, y and z

    [[nodiscard]] float least() const { return at_first + (kLeafSide - 1) * steps.cwiseMin(0.0F).sum(); }
    [[nodiscard]] float greatest() const { return at_first + (kLeafSide - 1) * steps.cwiseMax(0.0F).sum(); }
  };
  /// What is known of a leaf before its voxels are looked up.
  struct Outlook {
    Sight sight = Sight::nothing;
    Linear behind = {};  ///< where it is positive, voxels are behind the band around all that their pixels show
    Eigen::Vector3f corner = Eigen::Vector3f::Zero();  ///< the leaf's first voxel in the camera frame
  };

  /// By the bounds of the pixels around a leaf.
  [[nodiscard]] Outlook look(const openvdb::Coord& origin) const;

  /// Looks the voxels of a leaf up of which something is to be seen. Projective distance, made perpendicular: the
  /// voxels' distance from the plane of the surface that their pixel shows. In front of the surface it is cut off, not
  /// left out: seen free space removes what other views took for the inside of thin objects. False if no voxel is
  /// nearer to the surface than the truncation distance: free space alone is nothing that needs a leaf.
  bool observe(const Outlook& outlook, LeafReading& reading) const;

 private:
  /// Of four voxels in the camera frame.
  struct Points {
    Float4 x, y, z;
  };
  /// Where they are seen: column and row, and whether that is between pixels of the image. Else they are 0.
  struct Pixels {
    Int4 inside;
    Float4 u, v;
  };
  struct Depths {
    Float4 inverse;      ///< 1/m; 0 where nothing is seen
    Float4 obliqueness;  ///< DepthView::signed_obliqueness()
  };
  /// How far four voxels are from the surface, metres.
  struct Distances {
    Int4 known;       ///< mask: the reading says something about the voxel
    Float4 distance;  ///< positive in front of the surface
    Float4 limit;     ///< the truncation distance
    Float4 sigma;     ///< standard deviation of the reading
  };

  /// look() for the pixels and depths that the leaf spans. They show a plane, up to residuals: depth minus z, over the
  /// depth, is there linear in space.
  [[nodiscard]] Outlook look(const Eigen::Vector3f& corner, const PixelRect& pixels, float nearest_z,
                             float farthest_z) const;
  /// observe(), and the same in the instructions of processors that have AVX2.
  bool observe_voxels(const Outlook& outlook, LeafReading& reading) const;
  bool observe_voxels_avx2(const Outlook& outlook, LeafReading& reading) const;
  /// What is plain needs fewer cases.
  template <Sight sight>
  bool observe_rows(const Outlook& outlook, LeafReading& reading) const;
  /// What becomes of a leaf's groups together.
  struct Found {
    Int4 near = {};     ///< mask: voxels nearer to the surface than the truncation distance
    Int4 surface = {};  ///< mask: voxels that have a colour
  };
  template <Sight sight>
  void observe_group(const Points& points, std::size_t group, LeafReading& reading, Found& found) const;
  template <Sight sight>
  [[nodiscard]] Pixels project(const Points& points) const;
  template <Sight sight>
  [[nodiscard]] Depths sample(const Pixels& pixels) const;
  template <Sight sight>
  [[nodiscard]] Distances measure(const Float4& z, const Depths& depths) const;
  [[nodiscard]] Int4 weigh(const Distances& distances) const;

  DepthView view_;
  geometry::Pose camera_from_world_;
  TsdfOptions options_;
  Eigen::Matrix3f steps_;  ///< columns: to the next voxel along x, y, z of the world, in the camera frame
  Float4 fx_, fy_, cx_, cy_, width_, stride_, right_, bottom_;
  Float4 voxel_size_, least_truncation_, truncation_sigmas_;
  Float4 best_variance_, steps_per_metre_;
};

}  // namespace eg::mapping
