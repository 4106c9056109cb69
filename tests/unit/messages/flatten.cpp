#include "tests/unit/messages/flatten.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>

namespace eg::messages {
namespace {

class Flattener {
 public:
  template <typename... Values>
  Flattener& operator()(const Values&... values) {
    (add(values), ...);
    return *this;
  }
  Flat result;

 private:
  template <typename Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void add(Number number) {
    if constexpr (std::is_floating_point_v<Number>) {
      result.reals.push_back(std::bit_cast<std::uint64_t>(static_cast<double>(number)));
    } else {
      result.integers.push_back(static_cast<std::int64_t>(number));
    }
  }
  void add(const std::string& text) { result.texts.push_back(text); }

  template <typename Derived>
  void add(const Eigen::MatrixBase<Derived>& matrix) {
    for (const auto value : matrix.derived().reshaped()) add(value);
  }
  template <typename Tag>
  void add(const base::Id<Tag>& id) {
    add(id.value);
  }
  template <typename T, std::size_t N>
  void add(const std::array<T, N>& array) {
    for (const T& item : array) add(item);
  }
  template <typename T>
  void add(const std::vector<T>& list) {
    add(list.size());
    for (const T& item : list) add(item);
  }
  void add(const cv::Mat& image) {
    (*this)(image.rows, image.cols, image.type());
    for (int y = 0; y < image.rows; ++y) {
      const std::uint8_t* row = image.ptr(y);
      for (std::size_t i = 0; i < image.elemSize() * static_cast<std::size_t>(image.cols); ++i) add(row[i]);
    }
  }

  void add(const image::FrameHeader& v) { (*this)(v.session, v.sequence, v.utime); }
  void add(const geometry::CameraModel& v) {
    (*this)(v.name, v.width, v.height, v.fx, v.fy, v.cx, v.cy, v.distortion, v.depth_units_per_metre, v.fps);
  }
  void add(const geometry::Pose& v) { (*this)(v.rotation, v.translation); }
  void add(const features::PointFeature& v) {
    (*this)(v.pixel, v.pixel_sigma, v.depth, v.depth_sigma, v.angle, v.octave, v.descriptor, v.track_id);
  }
  void add(const features::LineFeature& v) {
    (*this)(v.start_pixel, v.end_pixel, v.has_depth, v.start, v.end, v.start_covariance, v.end_covariance);
    (*this)(v.descriptor, v.direction, v.track_id);
  }
  void add(const features::PlaneFeature& v) {
    (*this)(v.plane.normal, v.plane.distance, v.covariance, v.centroid, v.support, v.hull);
  }
  void add(const features::DirectionFeature& v) { (*this)(v.kind, v.direction, v.covariance, v.support, v.source); }
  void add(const egraph::Covisibility& v) { (*this)(v.keyframe, v.shared_features); }
  void add(const egraph::KeyframeNode& v) { (*this)(v.id, v.sequence, v.utime, v.world_from_camera, v.covariance); }
  void add(const egraph::DirectionLandmark& v) {
    (*this)(v.id, v.kind, v.direction, v.covariance, v.observations, v.first_seen, v.last_seen);
  }
  void add(const egraph::Observation& v) { (*this)(v.keyframe, v.landmark, v.direction_in_camera, v.covariance); }
  void add(const egraph::RelativePose& v) { (*this)(v.first, v.second, v.first_from_second, v.covariance); }
  void add(const egraph::CorrectedPose& v) { (*this)(v.keyframe, v.world_from_camera); }
  void add(const egraph::GraphSnapshot::CovisibilityEdge& v) { (*this)(v.first, v.second, v.shared_features); }
  template <typename Id>
  void add(const tracking::Match<Id>& v) {
    (*this)(v.feature, v.id);
  }
  void add(const egraph::Association& v) {
    (*this)(static_cast<std::int32_t>(v.feature), v.landmark, v.sign, v.chi2, v.outlier_chi2);
  }
  void add(const tracking::LandmarkPositions::Point& v) { (*this)(v.position, v.alive); }
  void add(const tracking::LandmarkPositions::Line& v) { (*this)(v.start, v.end, v.alive); }
  void add(const geometry::Plane& v) { (*this)(v.normal, v.distance); }
  void add(const mapping::Mesh& v) { (*this)(v.vertices, v.normals, v.colours, v.triangles); }
};

}  // namespace

bool Flat::all_finite() const {
  return std::all_of(reals.begin(), reals.end(),
                     [](std::uint64_t bits) { return std::isfinite(std::bit_cast<double>(bits)); });
}

Flat flatten(const image::RgbdFrame& v) { return Flattener()(v.header, v.camera, v.colour, v.depth).result; }

Flat flatten(const features::FrameFeatures& v) {
  return Flattener()(v.header, v.camera, v.points, v.lines, v.planes, v.directions).result;
}

Flat flatten(const tracking::PoseEstimate& v) {
  return Flattener()(v.header, v.state, v.reason, v.has_pose, v.world_from_camera, v.covariance, v.keyframe,
                     v.rotation_reference, v.matched_points, v.matched_lines, v.matched_planes, v.matched_directions,
                     v.corrections)
      .result;
}

Flat flatten(const tracking::PoseCorrection& v) { return Flattener()(v.session, v.version, v.since, v.entries).result; }

Flat flatten(const egraph::Keyframe& v) {
  std::vector<double> distances = v.plane_distances;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const bool is_plane = v.directions[i].kind == features::DirectionKind::plane_normal;
    if (!is_plane && std::isnan(distances[i])) distances[i] = 0;
  }
  return Flattener()(v.header, v.id, v.world_from_camera, v.covariance, v.directions, distances, v.covisible,
                     v.relative_poses, v.moved)
      .result;
}

Flat flatten(const egraph::GraphUpdate& v) {
  return Flattener()(v.session, v.base_version, v.version, v.keyframe, v.landmarks, v.removed, v.observations,
                     v.covisible, v.relative_poses, v.moved, v.corrections)
      .result;
}

Flat flatten(const egraph::GraphSnapshot& v) {
  return Flattener()(v.session, v.version, v.keyframes, v.landmarks, v.observations, v.covisibility, v.relative_poses,
                     v.part, v.parts, v.next_landmark)
      .result;
}

Flat flatten(const mapping::MeshChunk& v) {
  return Flattener()(v.session, v.tile, v.revision, v.part, v.parts, v.tile_size, v.mesh).result;
}

Flat flatten(const MeshRequest& v) { return Flattener()(v.session).result; }
Flat flatten(const GraphRequest& v) { return Flattener()(v.session, v.have_version).result; }
Flat flatten(const Acknowledge& v) { return Flattener()(v.session, v.sequence, v.consumer).result; }
Flat flatten(const ResendRequest& v) { return Flattener()(v.session, v.channel, v.numbers).result; }
Flat flatten(const tracking::KeyframeLinks& v) {
  return Flattener()(v.world_from_camera, v.matches.points, v.matches.lines, v.matches.planes, v.directions).result;
}
Flat flatten(const tracking::LandmarkPositions& v) { return Flattener()(v.points, v.lines, v.planes).result; }
Flat flatten(const EndOfStream& v) { return Flattener()(v.session, v.frame_count, v.skipped_utimes).result; }
Flat flatten(const Control& v) { return Flattener()(v.request_id, v.command, v.service).result; }
Flat flatten(const ControlReply& v) { return Flattener()(v.request_id, v.service, v.ok, v.message).result; }

Flat flatten(const ServiceStatus& v) {
  return Flattener()(v.utime, v.service, v.host, v.pid, v.state, v.frames, v.dropped, v.rejected, v.last_rejection,
                     v.latency_p50_ms, v.latency_p90_ms, v.latency_p99_ms, v.latency_max_ms, v.cpu_seconds,
                     v.peak_memory_bytes)
      .result;
}

}  // namespace eg::messages
