#include "common/io/ply.hpp"
#include "common/mapping/mesh_parts.hpp"
#include "services/eval/commands.hpp"

namespace eg::service {

base::Result<Report> join_mesh_files(const std::filesystem::path& out, const std::vector<std::string>& parts) {
  std::vector<mapping::Mesh> meshes;
  for (const std::string& file : parts) {
    auto part = io::read_ply(file);
    if (!part) return tl::make_unexpected(part.error());
    if (part->normals.size() != part->vertices.size() || part->colours.size() != part->vertices.size()) {
      return base::fail(file + ": is no mesh of a mapper: it has no normals or no colours");
    }
    meshes.push_back(
        {std::move(part->vertices), std::move(part->normals), std::move(part->colours), std::move(part->triangles)});
  }
  const mapping::Mesh joined = mapping::join_meshes(meshes);
  if (const auto written = io::write_ply(out, io::view_of(joined)); !written) {
    return tl::make_unexpected(written.error());
  }
  return Report{out.string() + ": " + std::to_string(joined.vertices.size()) + " vertices, " +
                    std::to_string(joined.triangles.size()) + " triangles\n",
                {{"mesh", out.string()}, {"vertices", joined.vertices.size()}, {"triangles", joined.triangles.size()}}};
}

}  // namespace eg::service
