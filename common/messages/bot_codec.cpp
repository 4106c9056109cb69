#include <Eigen/Geometry>
#include <bot_core/pose_t.hpp>
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

}  // namespace eg::messages
