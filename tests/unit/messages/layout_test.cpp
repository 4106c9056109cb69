#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/unit/messages/random_messages.hpp"

namespace eg::messages {
namespace {

/// A field of a .lcm file.
struct Field {
  std::string type, name, size;  // size: what stands in brackets, or empty
  bool commented = false;
};

struct Type {
  std::string name;
  std::vector<Field> fields;
};

/// Reads the subset of LCM's grammar that this project's files keep to: one declaration per line.
Type read_type(const std::filesystem::path& path) {
  static const std::regex kStruct(R"(^struct (\w+) \{$)");
  static const std::regex kField(R"(^  (\w+) (\w+)(?:\[(\w+)\])?;( +// .+)?$)");
  Type type;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (std::regex_match(line, match, kStruct)) type.name = match[1];
    if (std::regex_match(line, match, kField)) type.fields.push_back({match[1], match[2], match[3], match[4].matched});
  }
  return type;
}

std::vector<Type> all_types() {
  std::vector<Type> types;
  for (const auto& entry : std::filesystem::directory_iterator(EGRAPH_SOURCE_DIR "/lcmtypes")) {
    // The types of other projects are as they are.
    if (!entry.path().filename().string().starts_with("egraph_msgs_")) continue;
    types.push_back(read_type(entry.path()));
    EXPECT_EQ(entry.path().filename(), "egraph_msgs_" + types.back().name + ".lcm");
  }
  return types;
}

bool is_count(const Field& field) { return field.name.starts_with("num_"); }
bool is_array(const Field& field) { return field.size.starts_with("num_"); }

/// The order that check_layout() relies on: counts, fields of fixed size, arrays, strings.
int stage(const Field& field, bool nested) {
  if (field.type == "string") return 3;
  if (is_array(field)) return 2;
  return is_count(field) && !nested ? 0 : 1;
}

TEST(Layout, CountsComeFirstThenFixedFieldsThenArraysThenStrings) {
  const auto types = all_types();
  ASSERT_GE(types.size(), 25U);
  std::set<std::string> nested;
  for (const Type& type : types) {
    for (const Field& field : type.fields) nested.insert(field.type);
  }
  for (const Type& type : types) {
    ASSERT_FALSE(type.fields.empty()) << type.name;
    int last = 0;
    for (const Field& field : type.fields) {
      const int now = stage(field, nested.count(type.name) > 0);
      EXPECT_GE(now, last) << type.name << "." << field.name;
      last = now;
      if (nested.count(type.name) > 0) {
        EXPECT_LT(now, 2) << type.name << "." << field.name << ": parts of messages have a fixed size";
      }
    }
  }
}

TEST(Layout, EveryFieldOfPlainTypeIsExplained) {
  static const std::set<std::string> kPlain = {"int8_t", "int16_t", "int32_t", "int64_t", "float",
                                               "double", "byte",    "boolean", "string"};
  for (const Type& type : all_types()) {
    for (const Field& field : type.fields) {
      EXPECT_TRUE(field.commented || kPlain.count(field.type) == 0) << type.name << "." << field.name;
    }
  }
}

/// Types are told apart by their fingerprints alone.
TEST(Layout, NoTypeIsTakenForAnother) {
  base::Random random(1);
  std::set<std::vector<std::uint8_t>> fingerprints;
  const auto add = [&](const Bytes& bytes) { fingerprints.insert({bytes.begin(), bytes.begin() + 8}); };
  add(encode(random_value<image::RgbdFrame>(random)));
  add(encode(random_value<features::FrameFeatures>(random)));
  add(encode(random_value<tracking::PoseEstimate>(random)));
  add(encode(random_value<tracking::PoseCorrection>(random)));
  add(encode(random_value<egraph::Keyframe>(random)));
  add(encode(random_value<egraph::GraphUpdate>(random)));
  add(encode(random_value<egraph::GraphSnapshot>(random)));
  add(encode(random_value<mapping::MeshChunk>(random)));
  add(encode(random_value<GraphRequest>(random)));
  add(encode(random_value<MeshRequest>(random)));
  add(encode(random_value<Acknowledge>(random)));
  add(encode(random_value<ResendRequest>(random)));
  add(encode(random_value<EndOfStream>(random)));
  add(encode(random_value<Control>(random)));
  add(encode(random_value<ControlReply>(random)));
  add(encode(random_value<ServiceStatus>(random)));
  add(encode(random_value<tracking::KeyframeLinks>(random)));
  add(encode(random_value<tracking::LandmarkPositions>(random)));
  EXPECT_EQ(fingerprints.size(), 18U);
}

/// What docs/messages.md and the receive buffers count on.
TEST(Layout, AFrameOfFeaturesIsSmallEnoughForOneMessage) {
  features::FrameFeatures frame;
  frame.points.resize(1000);
  frame.lines.resize(150);
  frame.planes.resize(20);
  for (auto& plane : frame.planes) plane.hull.resize(features::kMaxHullPoints);
  frame.directions.resize(100);
  EXPECT_LT(encode(frame).size(), 180'000U);
}

}  // namespace
}  // namespace eg::messages
