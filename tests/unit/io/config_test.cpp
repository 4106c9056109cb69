#include "common/io/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/nearest_name.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::io {
namespace {

using testing::HasSubstr;

enum class Detector { lsd, edlines };

struct Options {
  double angle = 0.1;
  int count = 5;
  std::int64_t big = 0;
  bool refine = true;
  std::string name = "a \"b\" \\ c";
  std::array<double, 3> weights = {1, 2.5, 1e-9};
  Detector detector = Detector::lsd;
  struct Lines {
    double min_length = 20;
  } lines;
};

ConfigSchema schema_of(Options& options) {
  ConfigSchema schema;
  schema.field("angle", options.angle, {0, 90}, "degrees");
  schema.field("count", options.count, {1, 100});
  schema.field("big", options.big, {});
  schema.field("refine", options.refine);
  schema.field("name", options.name);
  schema.list("weights", options.weights.data(), options.weights.size(), {-10, 10});
  schema.choice("detector", options.detector, {{"lsd", Detector::lsd}, {"edlines", Detector::edlines}});
  schema.section("lines", "segment detection").field("min_length", options.lines.min_length, {5, 640}, "pixels");
  return schema;
}

std::string error_of(std::string_view yaml) {
  Options options;
  const auto status = parse_config(yaml, "f.yaml", schema_of(options));
  EXPECT_FALSE(status.has_value()) << yaml;
  return status ? "" : status.error().message;
}

TEST(Config, SetsWhatIsGivenAndKeepsTheRest) {
  Options options;
  const auto status = parse_config(
      "# comment\nangle: 12.5\ncount: 7\nbig: 123456789012\nrefine: false\nname: \"x y\"\nweights: [0, -1, 3e-2]\n"
      "detector: edlines\nlines:\n  min_length: 30\n",
      "f.yaml", schema_of(options));
  ASSERT_TRUE(status.has_value()) << status.error().message;
  EXPECT_EQ(options.angle, 12.5);
  EXPECT_EQ(options.count, 7);
  EXPECT_EQ(options.big, 123456789012);
  EXPECT_FALSE(options.refine);
  EXPECT_EQ(options.name, "x y");
  EXPECT_EQ(options.weights[2], 0.03);
  EXPECT_EQ(options.detector, Detector::edlines);
  EXPECT_EQ(options.lines.min_length, 30);

  ASSERT_TRUE(parse_config("", "f.yaml", schema_of(options)).has_value());
  ASSERT_TRUE(parse_config("# only a comment\n", "f.yaml", schema_of(options)).has_value());
  ASSERT_TRUE(parse_config("lines:\n", "f.yaml", schema_of(options)).has_value());
  EXPECT_EQ(options.count, 7);
}

TEST(Config, NamesTheNearestKey) {
  EXPECT_EQ(error_of("count: 7\nangel: 3\n"), "f.yaml:2: unknown key 'angel'; did you mean 'angle'?");
  EXPECT_EQ(error_of("lines:\n  min_lenght: 3\n"), "f.yaml:2: unknown key 'min_lenght'; did you mean 'min_length'?");
  EXPECT_EQ(error_of("lines:\n  qqqqqqqq: 3\n"), "f.yaml:2: unknown key 'qqqqqqqq'; known keys: min_length");
}

TEST(Config, RefusesWrongTypesAndRanges) {
  EXPECT_EQ(error_of("\nangle: wide\n"), "f.yaml:2: key 'angle' must be a number, not 'wide'");
  EXPECT_EQ(error_of("angle: 91\n"), "f.yaml:1: key 'angle' must be in [0, 90], not '91'");
  EXPECT_EQ(error_of("angle: .nan\n"), "f.yaml:1: key 'angle' must be a number, not '.nan'");
  EXPECT_EQ(error_of("angle: nan\n"), "f.yaml:1: key 'angle' must be a number, not 'nan'");
  EXPECT_EQ(error_of("angle: [1]\n"), "f.yaml:1: key 'angle' must be a number, not a list");
  EXPECT_EQ(error_of("angle:\n"), "f.yaml:1: key 'angle' must be a number, not nothing");
  EXPECT_EQ(error_of("count: 2.5\n"), "f.yaml:1: key 'count' must be an integer, not '2.5'");
  EXPECT_EQ(error_of("count: 99999999999\n"), "f.yaml:1: key 'count' must be in [1, 100], not '99999999999'");
  EXPECT_EQ(error_of("refine: yes\n"), "f.yaml:1: key 'refine' must be true or false, not 'yes'");
  EXPECT_EQ(error_of("name: {a: 1}\n"), "f.yaml:1: key 'name' must be text, not a mapping");
  EXPECT_EQ(error_of("weights: [1, 2]\n"), "f.yaml:1: key 'weights' must be a list of 3 numbers, but has 2");
  EXPECT_EQ(error_of("weights: [1, 2, x]\n"), "f.yaml:1: key 'weights' must be a number, not 'x'");
  EXPECT_EQ(error_of("weights: 3\n"), "f.yaml:1: key 'weights' must be a list of 3 numbers, not '3'");
  EXPECT_EQ(error_of("detector: fld\n"), "f.yaml:1: key 'detector' must be one of lsd, edlines, not 'fld'");
  EXPECT_EQ(error_of("lines: 3\n"), "f.yaml:1: key 'lines' must be a mapping, not '3'");
}

TEST(Config, RefusesRepeatedKeysAndWhatIsNoMapping) {
  EXPECT_EQ(error_of("count: 7\nangle: 1\ncount: 8\n"), "f.yaml:3: key 'count' is already given on line 1");
  EXPECT_EQ(error_of("- 1\n- 2\n"), "f.yaml:1: expected 'key: value' lines");
  EXPECT_EQ(error_of("[a]: 1\n"), "f.yaml:1: a key must be a plain word");
  EXPECT_THAT(error_of("count: 7\nangle: [1\n"), HasSubstr("no valid YAML: "));
  EXPECT_THAT(error_of("a: b: c\n"), HasSubstr("f.yaml:1: no valid YAML: "));
}

TEST(Config, RequiredKeysMustBeThere) {
  int width = 0;
  ConfigSchema schema;
  schema.field("width", width, {1, 10}, "pixels").required();
  EXPECT_EQ(parse_config("", "f.yaml", schema).error().message, "f.yaml:1: key 'width' is missing: pixels");
  EXPECT_TRUE(parse_config("width: 3", "f.yaml", schema).has_value());
}

TEST(Config, PrintsWhatItReads) {
  Options written;
  written.detector = Detector::edlines;
  written.angle = 0.1 + 0.2;
  written.lines.min_length = 17;
  const std::string yaml = print_config(schema_of(written));
  EXPECT_THAT(yaml, HasSubstr("angle: 0.30000000000000004  # degrees\n"));
  EXPECT_THAT(yaml, HasSubstr("lines:  # segment detection\n  min_length: 17  # pixels\n"));
  Options read;
  read.name.clear();
  read.weights = {};
  const auto status = parse_config(yaml, "printed", schema_of(read));
  ASSERT_TRUE(status.has_value()) << status.error().message;
  EXPECT_EQ(read.angle, written.angle);
  EXPECT_EQ(read.name, written.name);
  EXPECT_EQ(read.weights, written.weights);
  EXPECT_EQ(read.detector, written.detector);
  EXPECT_EQ(print_config(schema_of(read)), yaml);
}

TEST(Config, ReadsFiles) {
  test::TemporaryFolder folder;
  Options options;
  EXPECT_THAT(read_config(folder.path() / "none.yaml", schema_of(options)).error().message,
              HasSubstr("none.yaml: cannot be read: No such file or directory"));
  EXPECT_THAT(read_config(folder.path(), schema_of(options)).error().message, HasSubstr("is a folder, not a file"));
  EXPECT_THAT(read_config(folder.write("c.yaml", "x: 1"), schema_of(options)).error().message,
              HasSubstr("c.yaml:1: unknown key 'x'"));
}

TEST(NearestName, EditDistance) {
  EXPECT_EQ(edit_distance("", ""), 0);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("sitting", "kitten"), 3);
}

}  // namespace
}  // namespace eg::io
