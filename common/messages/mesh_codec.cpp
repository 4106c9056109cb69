#include <algorithm>
#include <cmath>
#include <egraph_msgs/mesh_chunk_t.hpp>

#include "common/messages/codec.hpp"
#include "common/messages/guard.hpp"
#include "common/messages/wire.hpp"
#include "common/messages/wire_geometry.hpp"

namespace eg::messages {
namespace {

using mapping::Mesh;
using mapping::MeshChunk;
using Wire = egraph_msgs::mesh_chunk_t;

constexpr float kNormalTolerance = 1e-3F;

void write_vertices(const Mesh& mesh, Wire& wire) {
  wire.num_vertices = static_cast<std::int32_t>(mesh.vertices.size());
  wire.vertices.resize(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    egraph_msgs::mesh_vertex_t& vertex = wire.vertices[i];
    Eigen::Map<Eigen::Vector3f>(vertex.position) = mesh.vertices[i];
    Eigen::Map<Eigen::Vector3f>(vertex.normal) = mesh.normals[i];
    std::copy(mesh.colours[i].begin(), mesh.colours[i].end(), vertex.colour);
  }
}

void read_vertices(const Wire& wire, const Path& path, Checker& check, Mesh& mesh) {
  const std::size_t count = wire.vertices.size();
  mesh.vertices.resize(count);
  mesh.normals.resize(count);
  mesh.colours.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const egraph_msgs::mesh_vertex_t& vertex = wire.vertices[i];
    mesh.vertices[i] = Eigen::Map<const Eigen::Vector3f>(vertex.position);
    mesh.normals[i] = Eigen::Map<const Eigen::Vector3f>(vertex.normal);
    std::copy(std::begin(vertex.colour), std::end(vertex.colour), mesh.colours[i].begin());
    const Path at = path("vertices", i);
    check.length(at("position"), mesh.vertices[i]);
    check.finite(at("normal"), mesh.normals[i]);
    check.require(std::abs(mesh.normals[i].norm() - 1) <= kNormalTolerance, at("normal"), "is no unit vector");
  }
}

void write_triangles(const Mesh& mesh, Wire& wire) {
  wire.num_triangles = static_cast<std::int32_t>(mesh.triangles.size());
  wire.triangles.resize(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EG_CHECK(mesh.triangles[i][k] < mesh.vertices.size(), "a triangle joins vertices of its mesh");
      wire.triangles[i].vertices[k] = static_cast<std::int16_t>(mesh.triangles[i][k]);
    }
  }
}

void read_triangles(const Wire& wire, const Path& path, Checker& check, Mesh& mesh) {
  mesh.triangles.resize(wire.triangles.size());
  for (std::size_t i = 0; i < wire.triangles.size(); ++i) {
    const Path at = path("triangles", i);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto vertex = static_cast<std::uint16_t>(wire.triangles[i].vertices[k]);
      check.in_range(at("vertices", k), vertex, 0, std::int64_t{wire.num_vertices} - 1);
      mesh.triangles[i][k] = vertex;
    }
  }
}

base::Result<MeshChunk> decode_chunk(ByteView bytes) {
  const auto wire = decode_wire<Wire>(bytes,
                                      {{"num_vertices", kMaxMeshVertices, wire_size<egraph_msgs::mesh_vertex_t>()},
                                       {"num_triangles", kMaxMeshTriangles, wire_size<egraph_msgs::mesh_triangle_t>()}},
                                      {});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  MeshChunk chunk;
  chunk.session = wire->session;
  chunk.tile = Eigen::Map<const Eigen::Vector3i>(wire->tile);
  chunk.revision = read_count(wire->revision, path("revision"), check);
  chunk.parts = wire->parts;
  chunk.part = wire->part;
  check.in_range(path("parts"), wire->parts, 1, INT32_MAX);
  check.in_range(path("part"), wire->part, 0, std::int64_t{wire->parts} - 1);
  chunk.tile_size = wire->tile_size;
  check.positive(path("tile_size"), wire->tile_size);
  read_vertices(*wire, path, check, chunk.mesh);
  read_triangles(*wire, path, check, chunk.mesh);
  return checked(std::move(chunk), check);
}

}  // namespace

Bytes encode(const MeshChunk& chunk) {
  const Mesh& mesh = chunk.mesh;
  EG_CHECK(mesh.vertices.size() <= std::size_t{kMaxMeshVertices}, "a chunk's vertex indices fit into 16 bits");
  EG_CHECK(mesh.normals.size() == mesh.vertices.size() && mesh.colours.size() == mesh.vertices.size(),
           "a mesh has one normal and one colour per vertex");
  Wire wire{};
  wire.session = chunk.session;
  Eigen::Map<Eigen::Vector3i>(wire.tile) = chunk.tile;
  wire.revision = chunk.revision;
  wire.part = chunk.part;
  wire.parts = chunk.parts;
  wire.tile_size = chunk.tile_size;
  write_vertices(mesh, wire);
  write_triangles(mesh, wire);
  return encode_wire(wire);
}

template <>
base::Result<MeshChunk> decode(ByteView bytes) {
  return guarded<MeshChunk>([&] { return decode_chunk(bytes); });
}

}  // namespace eg::messages
