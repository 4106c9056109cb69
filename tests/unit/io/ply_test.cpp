#include "common/io/ply.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <limits>

#include "common/base/random.hpp"
#include "common/io/mesh_files.hpp"
#include "common/io/pcd.hpp"
#include "common/io/text_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::io {
namespace {

using testing::HasSubstr;
using Triangle = std::array<std::uint32_t, 3>;

mapping::Mesh random_mesh(int vertices, int triangles) {
  base::Random random(11);
  const auto coordinate = [&] { return static_cast<float>(random.normal()); };
  const auto byte = [&] { return static_cast<std::uint8_t>(random.index(256)); };
  const auto index = [&] { return static_cast<std::uint32_t>(random.index(vertices)); };
  mapping::Mesh mesh;
  for (int i = 0; i < vertices; ++i) {
    mesh.vertices.emplace_back(coordinate(), coordinate(), coordinate());
    mesh.normals.emplace_back(coordinate(), coordinate(), coordinate());
    mesh.colours.push_back({byte(), byte(), byte()});
  }
  for (int i = 0; i < triangles; ++i) mesh.triangles.push_back({index(), index(), index()});
  return mesh;
}

class Ply : public testing::Test {
 protected:
  base::Result<PlyData> read(std::string_view bytes) { return read_ply(folder_.write("m.ply", bytes)); }
  std::string error(std::string_view bytes) {
    const auto data = read(bytes);
    EXPECT_FALSE(data.has_value());
    return data ? "" : data.error().message;
  }
  test::TemporaryFolder folder_;
};

TEST_F(Ply, MeshesComeBackBitByBit) {
  const mapping::Mesh mesh = random_mesh(500, 300);
  const auto path = folder_.path() / "w.ply";
  ASSERT_TRUE(write_ply(path, view_of(mesh)).has_value());
  const auto data = read_ply(path);
  ASSERT_TRUE(data.has_value()) << data.error().message;
  EXPECT_EQ(data->vertices, mesh.vertices);
  EXPECT_EQ(data->normals, mesh.normals);
  EXPECT_EQ(data->colours, mesh.colours);
  EXPECT_EQ(data->triangles, mesh.triangles);
  EXPECT_TRUE(data->edges.empty());
  EXPECT_EQ(format_ply(view_of(*data)), *read_file(path));
}

TEST_F(Ply, PiecesMakeTheSameFilesAsTheWhole) {
  const mapping::Mesh mesh = random_mesh(9000, 500);  // more than is copied at once
  mapping::Mesh first, second;
  const auto split = [](const auto& from, std::ptrdiff_t at, auto& a, auto& b) {
    a.assign(from.begin(), from.begin() + at);
    b.assign(from.begin() + at, from.end());
  };
  split(mesh.vertices, 6000, first.vertices, second.vertices);
  split(mesh.normals, 6000, first.normals, second.normals);
  split(mesh.colours, 6000, first.colours, second.colours);
  split(mesh.triangles, 100, first.triangles, second.triangles);
  const auto stem = folder_.path() / "pieces";
  auto files = MeshFiles::create(stem);
  ASSERT_TRUE(files) << files.error().message;
  for (const mapping::Mesh& piece : {first, second, mapping::Mesh()}) ASSERT_TRUE(files->add(piece));
  ASSERT_TRUE(files->finish());
  EXPECT_EQ(*read_file(stem.string() + ".ply"), format_ply(view_of(mesh)));
  EXPECT_EQ(*read_file(stem.string() + ".pcd"), format_pcd(view_of(mesh)));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 2) << "nothing else is left";
}

TEST_F(Ply, NoPiecesMakeEmptyFiles) {
  auto files = MeshFiles::create(folder_.path() / "empty");
  ASSERT_TRUE(files && files->finish());
  EXPECT_EQ(*read_file(folder_.path() / "empty.ply"), format_ply({}));
  EXPECT_EQ(*read_file(folder_.path() / "empty.pcd"), format_pcd({}));
  EXPECT_FALSE(MeshFiles::create(folder_.path() / "nowhere" / "mesh"));
}

TEST_F(Ply, CloudsAndLineSetsComeBack) {
  PlyData data;
  data.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  data.colours = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}};
  data.edges = {{0, 1}, {1, 2}};
  const auto back = read(format_ply(view_of(data)));
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_EQ(back->vertices, data.vertices);
  EXPECT_EQ(back->colours, data.colours);
  EXPECT_EQ(back->edges, data.edges);
  EXPECT_TRUE(back->normals.empty());
  EXPECT_TRUE(back->triangles.empty());
}

TEST_F(Ply, ReadsWhatOtherProgramsWrite) {
  const auto data = read(
      "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement vertex 4\r\nproperty double x\r\nproperty double "
      "y\r\n"
      "property double z\r\nproperty uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\nproperty float "
      "quality\r\n"
      "element face 1\r\nproperty list uchar uint vertex_index\r\nelement extra 1\r\nproperty int "
      "what\r\nend_header\r\n"
      "0 0 0 1 2 3 0.5\r\n1 0 0 1 2 3 0.5\r\n1 1 0 1 2 3 0.5\r\n0 1 0.25 1 2 3 0.5\r\n4 0 1 2 3\r\n17\r\n");
  ASSERT_TRUE(data.has_value()) << data.error().message;
  EXPECT_EQ(data->vertices[3], Eigen::Vector3f(0, 1, 0.25));
  EXPECT_EQ(data->colours[2], (mapping::Colour{1, 2, 3}));
  EXPECT_EQ(data->triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST_F(Ply, ColoursThatNoByteHoldsBecomeTheNearest) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "property float red\nproperty float green\nproperty float blue\nend_header\n";
  for (const float value : {1.0F, 2.0F, 3.0F, std::numeric_limits<float>::quiet_NaN(), -5.0F, 1e30F}) {
    const auto number = std::bit_cast<std::array<char, sizeof value>>(value);
    bytes.append(number.data(), number.size());
  }
  const auto data = read(bytes);
  ASSERT_TRUE(data) << data.error().message;
  EXPECT_EQ(data->colours, (std::vector<mapping::Colour>{{0, 0, 255}}));
}

TEST_F(Ply, EveryTruncationIsFound) {
  const std::string whole = format_ply(view_of(random_mesh(4, 3)));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(read(std::string_view(whole).substr(0, length)).has_value()) << length;
  }
}

TEST_F(Ply, AnEmptyMeshComesBackEmpty) {
  const auto back = read(format_ply(PlyView{}));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_TRUE(back->vertices.empty());
}

TEST_F(Ply, SaysWhatIsWrong) {
  constexpr char kVertex[] = "property float x\nproperty float y\nproperty float z\n";
  const auto ascii = [&](const std::string& rest) { return "ply\nformat ascii 1.0\n" + rest; };
  EXPECT_THAT(error(""), HasSubstr("m.ply: is empty"));
  EXPECT_THAT(error("solid stl\n"), HasSubstr("m.ply: is no PLY file"));
  const std::string vertex = std::string("element vertex 1\n") + kVertex;
  EXPECT_THAT(error(ascii(vertex + vertex + "end_header\n1 2 3\n4 5 6\n")), HasSubstr("holds vertices in two places"));
  EXPECT_THAT(error("ply\nformat binary_big_endian 1.0\nend_header\n"), HasSubstr("header line 2: format 'binary_big"));
  EXPECT_THAT(error(ascii("element vertex many\nend_header\n")), HasSubstr("header line 3: expected 'element NAME"));
  EXPECT_THAT(error(ascii("property float x\nend_header\n")), HasSubstr("header line 3: property before the first"));
  EXPECT_THAT(error(ascii("element vertex 1\nproperty real x\nend_header\n1\n")), HasSubstr("unknown type 'real'"));
  EXPECT_THAT(error(ascii("element vertex 1\nproperty float x\nend_header\n1\n")), HasSubstr("no coordinates x, y, z"));
  EXPECT_THAT(error(ascii("end_header\n")), HasSubstr("holds no vertex"));
  EXPECT_THAT(error(ascii("element vertex 1\n") + kVertex), HasSubstr("PLY header has no end"));
  EXPECT_THAT(error(ascii("element vertex 2\n") + kVertex + "end_header\n1 2 3\n"),
              HasSubstr("less data than its header"));
  EXPECT_THAT(error(ascii("element vertex 999999999999\n") + kVertex + "end_header\n1 2 3\n"), HasSubstr("less data"));
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n";
  EXPECT_THAT(error(ascii("element vertex 1\n") + kVertex + face + "3 0 0 1\n"),
              HasSubstr("vertex that does not exist"));
  EXPECT_THAT(error(ascii("element vertex 1\n") + kVertex + face + "3 0 0 -1\n"),
              HasSubstr("vertex that does not exist"));
  mapping::Mesh mesh = random_mesh(3, 1);
  mesh.vertices[1].y() = std::numeric_limits<float>::infinity();
  EXPECT_THAT(error(format_ply(view_of(mesh))), HasSubstr("vertex 1 is not finite"));
}

}  // namespace
}  // namespace eg::io
