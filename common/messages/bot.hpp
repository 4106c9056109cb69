#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/messages/codec.hpp"

/// Messages that robots and viewers of the LCM world (libbot2) understand. They are only sent, never received.
namespace eg::messages::bot {

/// bot_core.pose_t
struct BodyPose {
  std::int64_t utime = 0;  ///< microseconds
  geometry::Pose world_from_body;
};

/// vs.object_collection_t of type POSE3D. An object that is sent again is moved.
struct ObjectCollection {
  struct Object {
    std::int64_t id = 0;
    geometry::Pose world_from_object;
  };
  std::int32_t id = 0;
  std::string name;
  std::vector<Object> objects;
};

/// vs.link_collection_t between objects of one collection.
struct LinkCollection {
  struct Link {
    std::int64_t id = 0;
    std::int64_t first = 0;  ///< object ids
    std::int64_t second = 0;
  };
  std::int32_t id = 0;
  std::string name;
  std::int32_t objects = 0;  ///< id of the ObjectCollection
  std::vector<Link> links;
};

/// bot_core.pointcloud2_t with the fields x, y, z and rgb, the latter as bits of a float, as PCL has it.
struct PointCloud {
  struct Point {
    Eigen::Vector3f position;
    std::array<std::uint8_t, 3> colour{};  ///< red, green, blue
  };
  std::int64_t utime = 0;
  std::string frame;
  std::vector<Point> points;
};

}  // namespace eg::messages::bot

namespace eg::messages {

// A file that publishes these by ServiceContext::publish() includes this header before service.hpp.
Bytes encode(const bot::BodyPose& pose);
Bytes encode(const bot::ObjectCollection& collection);
Bytes encode(const bot::LinkCollection& collection);
Bytes encode(const bot::PointCloud& cloud);

}  // namespace eg::messages
