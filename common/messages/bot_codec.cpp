#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <bot_core/pointcloud2_t.hpp>
#include <bot_core/pose_t.hpp>
#include <cstring>
#include <vs/link_collection_t.hpp>
#include <vs/object_collection_t.hpp>

#include "common/messages/bot.hpp"
#include "common/messages/limits.hpp"
#include "common/messages/wire.hpp"
#include "common/messages/wire_geometry.hpp"

namespace eg::messages {
namespace {

using bot::BodyPose;
using bot::LinkCollection;
using bot::ObjectCollection;

constexpr std::int16_t kPose3d = 4;
constexpr std::int8_t kFloat32 = 7;

vs::object_t write(const ObjectCollection::Object& object) {
  const Eigen::Vector3d& position = object.world_from_object.translation;
  const Eigen::Quaterniond rotation(object.world_from_object.rotation);
  vs::object_t wire{};
  wire.id = object.id;
  wire.x = position.x();
  wire.y = position.y();
  wire.z = position.z();
  wire.qw = rotation.w();
  wire.qx = rotation.x();
  wire.qy = rotation.y();
  wire.qz = rotation.z();
  return wire;
}

}  // namespace

Bytes encode(const BodyPose& pose) {
  const Eigen::Quaterniond rotation(pose.world_from_body.rotation);
  bot_core::pose_t wire{};
  wire.utime = pose.utime;
  write_vector(pose.world_from_body.translation, wire.pos);
  write_vector(Eigen::Vector4d(rotation.w(), rotation.x(), rotation.y(), rotation.z()), wire.orientation);
  return encode_wire(wire);
}

Bytes encode(const ObjectCollection& collection) {
  vs::object_collection_t wire{};
  wire.id = collection.id;
  wire.name = printable(collection.name, kMaxName);
  wire.type = kPose3d;
  wire.nobjects = static_cast<std::int32_t>(collection.objects.size());
  for (const ObjectCollection::Object& object : collection.objects) wire.objects.push_back(write(object));
  return encode_wire(wire);
}

Bytes encode(const LinkCollection& collection) {
  vs::link_collection_t wire{};
  wire.id = collection.id;
  wire.name = printable(collection.name, kMaxName);
  wire.nlinks = static_cast<std::int32_t>(collection.links.size());
  for (const LinkCollection::Link& link : collection.links) {
    vs::link_t& written = wire.links.emplace_back();
    written.id = link.id;
    written.collection1 = written.collection2 = collection.objects;
    written.id1 = link.first;
    written.id2 = link.second;
  }
  return encode_wire(wire);
}

Bytes encode(const bot::PointCloud& cloud) {
  constexpr std::array kFields = {"x", "y", "z", "rgb"};
  constexpr auto kStep = static_cast<std::int32_t>(kFields.size() * sizeof(float));
  bot_core::pointcloud2_t wire{};
  wire.utime = cloud.utime;
  wire.frame_id = printable(cloud.frame, kMaxName);
  wire.height = 1;
  wire.width = static_cast<std::int32_t>(cloud.points.size());
  wire.nfields = kFields.size();
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    bot_core::pointfield_t& field = wire.fields.emplace_back();
    field.name = kFields[i];
    field.offset = static_cast<std::int32_t>(i * sizeof(float));
    field.datatype = kFloat32;
    field.count = 1;
  }
  wire.is_bigendian = std::endian::native == std::endian::big ? 1 : 0;
  wire.point_step = kStep;
  wire.row_step = wire.data_nbytes = kStep * wire.width;
  wire.is_dense = 1;
  for (const bot::PointCloud::Point& point : cloud.points) {
    const std::uint32_t rgb = static_cast<std::uint32_t>(point.colour[0]) << 16U |
                              static_cast<std::uint32_t>(point.colour[1]) << 8U | point.colour[2];
    const std::array<float, kFields.size()> values = {point.position.x(), point.position.y(), point.position.z(),
                                                      std::bit_cast<float>(rgb)};
    const auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof values>>(values);
    wire.data.insert(wire.data.end(), bytes.begin(), bytes.end());
  }
  return encode_wire(wire);
}

}  // namespace eg::messages
