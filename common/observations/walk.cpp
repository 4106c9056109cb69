#include "common/observations/walk.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/random.hpp"
#include "common/observations/visible_part.hpp"
#include "common/synthetic/trajectory.hpp"

namespace eg::observations {
namespace {

using Eigen::Vector3d;
using geometry::CameraModel;
using geometry::Pose;

// Of every room, metres: it reaches from k to k + 1 lengths along x, doors are in the middle of both ends.
constexpr double kLength = 5.0, kHalfWidth = 2.5, kHeight = 2.6;
constexpr double kDoorHalfWidth = 0.5, kDoorHeight = 2.1;
constexpr int kCornersPerWall = 250;
constexpr int kBoards = 3;  // per side wall
constexpr double kMinLinePixels = 30.0;
constexpr double kNearest = 0.3, kFurthest = 8.0;  // metres, of a structured-light camera

struct Landmark {
  std::int32_t id = -1;
  Vector3d position = Vector3d::Zero();
};

struct Edge {
  std::int32_t id = -1;
  Vector3d start = Vector3d::Zero(), end = Vector3d::Zero();
};

struct Room {
  std::vector<Landmark> corners;
  std::vector<Edge> edges;
};

bool in_door(double y, double z) { return std::abs(y) < kDoorHalfWidth && z < kDoorHeight; }

/// Makes rooms one after the other and gives out identities.
class Builder {
 public:
  Builder(std::uint64_t seed, Recording& recording) : random_(seed), recording_(recording) {}

  Room room(int number) {
    const double begin = number * kLength;
    Room room;
    add_corners(room, begin);
    add_box(room, begin);
    add_door(room, begin);
    for (int i = 0; i < kBoards; ++i) add_boards(room, begin);
    return room;
  }

 private:
  void add_corners(Room& room, double begin) {
    const auto along = [&] { return begin + random_.uniform(0.1, kLength - 0.1); };
    const auto across = [&] { return random_.uniform(-kHalfWidth + 0.1, kHalfWidth - 0.1); };
    const auto up = [&] { return random_.uniform(0.1, kHeight - 0.1); };
    for (int i = 0; i < kCornersPerWall; ++i) {
      for (const double side : {-kHalfWidth, kHalfWidth}) add_corner(room, {along(), side, up()});
      for (const double level : {0.0, kHeight}) add_corner(room, {along(), across(), level});
      const double y = across();
      const double z = up();
      if (!in_door(y, z)) add_corner(room, {begin, y, z});
    }
  }

  void add_box(Room& room, double begin) {
    for (const double y : {-kHalfWidth, kHalfWidth}) {
      for (const double z : {0.0, kHeight}) add_edge(room, {begin, y, z}, {begin + kLength, y, z});
      add_edge(room, {begin, y, 0.0}, {begin, y, kHeight});
    }
    for (const double z : {0.0, kHeight}) add_edge(room, {begin, -kHalfWidth, z}, {begin, kHalfWidth, z});
  }

  void add_door(Room& room, double x) {
    for (const double y : {-kDoorHalfWidth, kDoorHalfWidth}) add_edge(room, {x, y, 0.0}, {x, y, kDoorHeight});
    add_edge(room, {x, -kDoorHalfWidth, kDoorHeight}, {x, kDoorHalfWidth, kDoorHeight});
  }

  /// A board on each side wall, and a rug.
  void add_boards(Room& room, double begin) {
    const double left = begin + random_.uniform(0.8, 2.0);
    const double right = left + random_.uniform(0.8, 2.0);
    const double low = random_.uniform(0.6, 1.0);
    const double high = low + random_.uniform(0.5, 1.0);
    for (const double y : {-kHalfWidth, kHalfWidth}) {
      for (const double z : {low, high}) add_edge(room, {left, y, z}, {right, y, z});
      for (const double x : {left, right}) add_edge(room, {x, y, low}, {x, y, high});
    }
    for (const double y : {-1.0, 1.0}) add_edge(room, {left, y, 0.0}, {right, y, 0.0});
    for (const double x : {left, right}) add_edge(room, {x, -1.0, 0.0}, {x, 1.0, 0.0});
  }

  void add_corner(Room& room, const Vector3d& position) { room.corners.push_back({next_point_++, position}); }

  /// All edges run along an axis of the world, which is their group.
  void add_edge(Room& room, const Vector3d& start, const Vector3d& end) {
    Eigen::Index axis = 0;
    (end - start).cwiseAbs().maxCoeff(&axis);
    recording_.line_groups[next_line_] = static_cast<std::int32_t>(axis);
    room.edges.push_back({next_line_++, start, end});
  }

  base::Random random_;
  Recording& recording_;
  std::int32_t next_point_ = 0;
  std::int32_t next_line_ = 0;
};

/// In every room once from door to door, to either side on the way, and three times around. Doors are passed
/// straight, quickly and looking through them: a wall a hand away shows nothing.
synthetic::Trajectory walk_through(const WalkOptions& options) {
  const double period = options.seconds_per_room;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return {.name = "walk",
          .duration_s = options.rooms * period,
          .x = {.offset = kLength, .rate = kLength / period, .waves = {{0.9 * kLength / kTurn, period, 0.0}}},
          .y = {.offset = 0.0, .waves = {{1.1, period, 0.0}, {-0.55, period / 2.0, 0.0}}},
          .z = {.offset = 1.4, .waves = {{0.1, 7.0, 0.2}}},
          .heading = {.offset = 0.0, .rate = 3.0 * kTurn / period, .waves = {{-1.0, period / 3.0, 0.0}}},
          .tilt = {.offset = 0.1, .waves = {{0.15, 8.3, 0.1}}},
          .roll = {.waves = {{0.05, 5.3, 0.4}}}};
}

/// What a camera in the row of rooms sees.
class Viewer {
 public:
  Viewer(const std::vector<Room>& rooms, const CameraModel& camera, const SensorModel& sensor, std::uint64_t seed)
      : rooms_(rooms), camera_(camera), sensor_(sensor), random_(seed) {}

  void look(RecordedFrame& frame) {
    const Vector3d& eye = frame.world_from_camera.translation;
    const Pose camera_from_world = frame.world_from_camera.inverse();
    const int own = std::clamp(static_cast<int>(std::floor(eye.x() / kLength)), 0, last_room());
    for (int room = std::max(own - 1, 0); room <= std::min(own + 1, last_room()); ++room) {
      for (const Landmark& corner : rooms_[static_cast<std::size_t>(room)].corners) {
        if (in_sight(eye, corner.position, own)) see_point(corner, camera_from_world, frame);
      }
    }
    // The far end's edges are those of the next room's near end.
    see_edges(rooms_[static_cast<std::size_t>(own)].edges, camera_from_world, frame, own * kLength + kLength);
    if (own < last_room()) {
      see_edges(rooms_[static_cast<std::size_t>(own + 1)].edges, camera_from_world, frame, own * kLength + kLength);
    }
  }

 private:
  [[nodiscard]] int last_room() const { return static_cast<int>(rooms_.size()) - 1; }

  /// Whether no wall is between: what is outside the camera's own room is seen through a door.
  [[nodiscard]] static bool in_sight(const Vector3d& eye, const Vector3d& position, int own) {
    for (const double wall : {own * kLength, (own + 1) * kLength}) {
      const bool beyond = wall > eye.x() ? position.x() > wall : position.x() < wall;
      if (!beyond) continue;
      const double share = (wall - eye.x()) / (position.x() - eye.x());
      const Vector3d at = eye + share * (position - eye);
      if (!in_door(at.y(), at.z())) return false;
    }
    return true;
  }

  void see_point(const Landmark& corner, const Pose& camera_from_world, RecordedFrame& frame) {
    const Vector3d point = camera_from_world * corner.position;
    if (point.z() < kNearest || point.z() > kFurthest) return;
    const Eigen::Vector2d pixel = camera_.project(point) + noise();
    if (camera_.contains(pixel)) frame.points.push_back({corner.id, pixel, point.z()});
  }

  /// Edges that lie within the room that ends at `end`.
  void see_edges(const std::vector<Edge>& edges, const Pose& camera_from_world, RecordedFrame& frame, double end) {
    for (const Edge& edge : edges) {
      if (std::max(edge.start.x(), edge.end.x()) > end) continue;
      const auto part =
          visible_part({camera_from_world * edge.start, camera_from_world * edge.end}, camera_, kNearest, kFurthest);
      if (!part) continue;
      const Eigen::Vector2d start = camera_.project(part->start);
      const Eigen::Vector2d stop = camera_.project(part->end);
      if ((stop - start).norm() < kMinLinePixels) continue;
      const LineObservation seen{edge.id, start + noise(), stop + noise(), part->start.z() + depth_noise(),
                                 part->end.z() + depth_noise()};
      if (camera_.contains(seen.start_pixel) && camera_.contains(seen.end_pixel)) frame.lines.push_back(seen);
    }
  }

  Eigen::Vector2d noise() {
    const double u = random_.normal();
    return sensor_.pixel_sigma * Eigen::Vector2d(u, random_.normal());
  }
  double depth_noise() { return sensor_.line_depth_sigma * random_.normal(); }

  const std::vector<Room>& rooms_;
  const CameraModel& camera_;
  const SensorModel& sensor_;
  base::Random random_;
};

}  // namespace

Recording make_walk(const CameraModel& camera, const SensorModel& sensor, const WalkOptions& options) {
  Recording recording;
  Builder builder(options.seed, recording);
  std::vector<Room> rooms;
  // One more at either end: the walk begins and ends in a door.
  for (int number = 0; number < options.rooms + 2; ++number) rooms.push_back(builder.room(number));

  const synthetic::Trajectory trajectory = walk_through(options);
  Viewer viewer(rooms, camera, sensor, options.seed + 1);
  const auto frames = static_cast<int>(trajectory.duration_s * camera.fps);
  for (int i = 0; i < frames; ++i) {
    const double time = i / camera.fps;
    RecordedFrame& frame = recording.frames.emplace_back();
    frame.time_s = time;
    frame.world_from_camera = trajectory.world_from_camera(time);
    viewer.look(frame);
  }
  return recording;
}

}  // namespace eg::observations
