#include "services/viewer/packet.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/service/viewer/read_packet.hpp"

namespace eg::services {
namespace {

test::ReadPacket read(const Packet& packet) {
  const std::vector<std::uint8_t> bytes = packet.bytes();
  return test::ReadPacket(std::string(bytes.begin(), bytes.end()));
}

TEST(Packet, CarriesFieldsAndAlignedArrays) {
  const std::vector<float> floats = {1.5F, -2.0F};
  const std::vector<std::uint8_t> bytes = {7, 8, 9};
  const std::vector<std::int32_t> integers = {-5};
  Packet packet("test");
  packet.set("x", 0.1).set_flag("yes", true).array("b", bytes).array("f", floats).array("i", integers);
  const auto result = read(packet);
  EXPECT_EQ(result.head["type"], "test");
  EXPECT_EQ(result.head["x"], 0.1);
  EXPECT_EQ(result.head["yes"], true);
  EXPECT_EQ(result.head["arrays"].dump(), R"([["b","u8",3],["f","f32",2],["i","i32",1]])");
  EXPECT_EQ(result.array<std::uint8_t>("b"), bytes);
  EXPECT_EQ(result.array<float>("f"), floats);
  EXPECT_EQ(result.array<std::int32_t>("i"), integers);
}

TEST(Packet, PassesAnyTextAndNumberOn) {
  const std::string text = "a \"quoted\" \\ line\n\x01 with ü";
  Packet packet("test");
  packet.set("text", text).set("nan", std::numeric_limits<double>::quiet_NaN());
  const auto result = read(packet);
  EXPECT_EQ(result.head["text"], text);
  EXPECT_TRUE(result.head["nan"].is_null());
}

}  // namespace
}  // namespace eg::services
