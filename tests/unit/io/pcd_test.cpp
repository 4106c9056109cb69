#include "common/io/pcd.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

namespace eg::io {
namespace {

/// As the format's description has it, byte for byte.
TEST(PcdTest, WritesPointsWithNormalsAndColours) {
  PlyData cloud;
  cloud.vertices = {{1.0F, 2.0F, 3.0F}, {-1.0F, 0.5F, 0.0F}};
  cloud.normals = {{0.0F, 0.0F, 1.0F}, {0.0F, 1.0F, 0.0F}};
  cloud.colours = {{255, 128, 1}, {0, 0, 7}};
  const std::string header =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z normal_x normal_y normal_z rgb\n"
      "SIZE 4 4 4 4 4 4 4\nTYPE F F F F F F F\nCOUNT 1 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
      "POINTS 2\nDATA binary\n";
  const std::string bytes = format_pcd(view_of(cloud));
  ASSERT_EQ(bytes.substr(0, header.size()), header);
  ASSERT_EQ(bytes.size(), header.size() + 2 * 28);
  const float expected[] = {1.0F, 2.0F, 3.0F, 0.0F, 0.0F, 1.0F};
  EXPECT_EQ(std::memcmp(bytes.data() + header.size(), expected, sizeof expected), 0);
  EXPECT_EQ(bytes.substr(header.size() + 24, 4), std::string("\x01\x80\xff\0", 4));
}

TEST(PcdTest, LeavesOutWhatThereIsNot) {
  PlyData cloud;
  const std::string empty = format_pcd(view_of(cloud));
  EXPECT_NE(empty.find("FIELDS x y z\n"), std::string::npos);
  EXPECT_NE(empty.find("POINTS 0\nDATA binary\n"), std::string::npos);
  EXPECT_TRUE(empty.ends_with("DATA binary\n"));
}

}  // namespace
}  // namespace eg::io
