#include "services/viewer/packet.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

namespace eg::services {
namespace {

/// A packet as the page reads it.
struct Read {
  explicit Read(std::vector<std::uint8_t> packet) : bytes(std::move(packet)) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data(), sizeof size);
    EXPECT_EQ(size % 4, 0u);
    head = nlohmann::json::parse(bytes.begin() + 4, bytes.begin() + 4 + size);
    body = 4 + size;
  }
  std::vector<std::uint8_t> bytes;
  nlohmann::json head;
  std::size_t body = 0;
};

TEST(Packet, CarriesFieldsAndAlignedArrays) {
  const std::vector<float> floats = {1.5F, -2.0F};
  const std::vector<std::uint8_t> bytes = {7, 8, 9};
  const std::vector<std::int32_t> integers = {-5};
  const Read read(Packet("test")
                      .set("x", 0.1)
                      .set_flag("yes", true)
                      .array("b", bytes)
                      .array("f", floats)
                      .array("i", integers)
                      .bytes());
  EXPECT_EQ(read.head["type"], "test");
  EXPECT_EQ(read.head["x"], 0.1);
  EXPECT_EQ(read.head["yes"], true);
  EXPECT_EQ(read.head["arrays"].dump(), R"([["b","u8",3],["f","f32",2],["i","i32",1]])");
  ASSERT_EQ(read.bytes.size(), read.body + 4 + 8 + 4);
  EXPECT_EQ(read.bytes[read.body + 2], 9);
  float second = 0.0F;
  std::memcpy(&second, read.bytes.data() + read.body + 8, sizeof second);
  EXPECT_EQ(second, -2.0F);
}

TEST(Packet, PassesAnyTextAndNumberOn) {
  const std::string text = "a \"quoted\" \\ line\n\x01 with ü";
  const Read read(Packet("test").set("text", text).set("nan", std::numeric_limits<double>::quiet_NaN()).bytes());
  EXPECT_EQ(read.head["text"], text);
  EXPECT_TRUE(read.head["nan"].is_null());
}

}  // namespace
}  // namespace eg::services
