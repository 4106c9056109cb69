#include "common/service/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <fstream>

#include "common/service/configuration.hpp"
#include "common/transport/lcm_url.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::service {
namespace {

using testing::HasSubstr;

class CommandLineTest : public testing::Test {
 protected:
  void TearDown() override {
    for (const char* name : {"EGRAPH_LCM_URL", "EGRAPH_OUT", "EGRAPH_LOCKSTEP", "EGRAPH_CONFIG", "EGRAPH_SPEED"}) {
      unsetenv(name);
    }
  }

  std::variant<CommandLine, int> parse(std::vector<const char*> arguments) {
    ServiceProgram program;
    program.name = "egraph_server";
    program.description = "Keeps the graph";
    program.add_options = [this](CLI::App& app) { app.add_option("--speed", speed_)->envname("EGRAPH_SPEED"); };
    arguments.insert(arguments.begin(), "program");
    return parse_command_line(program, static_cast<int>(arguments.size()), arguments.data());
  }

  double speed_ = 1.0;
};

TEST_F(CommandLineTest, HasGoodDefaults) {
  const auto parsed = std::get<CommandLine>(parse({}));
  EXPECT_EQ(parsed.options.name, "egraph_server");
  EXPECT_EQ(parsed.options.lcm_url, transport::kDefaultLcmUrl);
  EXPECT_TRUE(parsed.options.out.empty());
  EXPECT_FALSE(parsed.options.lockstep);
  EXPECT_FALSE(parsed.print_config);
}

TEST_F(CommandLineTest, ReadsTheEnvironmentButTheCommandLineWins) {
  setenv("EGRAPH_LCM_URL", "udpm://239.255.76.67:1?ttl=0", 1);
  setenv("EGRAPH_OUT", "/from/environment", 1);
  setenv("EGRAPH_LOCKSTEP", "1", 1);
  setenv("EGRAPH_CONFIG", "all.yaml", 1);
  setenv("EGRAPH_SPEED", "2.5", 1);
  const auto parsed = std::get<CommandLine>(parse({"--out", "/from/command/line"}));
  EXPECT_EQ(parsed.options.lcm_url, "udpm://239.255.76.67:1?ttl=0");
  EXPECT_EQ(parsed.options.out, "/from/command/line");
  EXPECT_EQ(parsed.options.config_file, "all.yaml");
  EXPECT_TRUE(parsed.options.lockstep);
  EXPECT_EQ(speed_, 2.5);
}

TEST_F(CommandLineTest, AnswersHelpAndMistakes) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(std::get<int>(parse({"--help"})), 0);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("--lcm-url"));
  testing::internal::CaptureStderr();
  EXPECT_NE(std::get<int>(parse({"--no-such-option"})), 0);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("--no-such-option"));
}

TEST(ExecutableName, IsTheServicesNameWithDashes) {
  EXPECT_EQ(executable_name("egraph_server"), "egraph-server");
  EXPECT_EQ(executable_name("feature_extractor"), "egraph-feature-extractor");
}

class ConfigurationTest : public testing::Test {
 protected:
  ConfigurationTest() {
    program_.name = "tracker";
    program_.configure = [this](io::ConfigSchema& section) { section.field("radius", radius_, {1.0, 9.0}, "metres"); };
  }
  base::Status read(const std::string& yaml) {
    std::ofstream(folder_.path() / "all.yaml") << yaml;
    return Configuration(program_).read(folder_.path() / "all.yaml");
  }

  test::TemporaryFolder folder_;
  ServiceProgram program_;
  double radius_ = 3.0;
};

TEST_F(ConfigurationTest, ReadsItsSectionAndLeavesTheOthersAlone) {
  ASSERT_TRUE(read("mapper:\n  voxel: [1, 2]\ntracker:\n  radius: 5\n"));
  EXPECT_EQ(radius_, 5.0);
  for (const char* other : {"frame_source", "feature_extractor", "egraph_server", "viewer"}) {
    EXPECT_TRUE(read(std::string(other) + ":\n  key: 1\n")) << other;
  }
}

TEST_F(ConfigurationTest, RejectsUnknownKeysWithTheirLine) {
  EXPECT_THAT(read("tracker:\n  radiu: 5\n").error().message, HasSubstr("all.yaml:2"));
  EXPECT_THAT(read("traker:\n  radius: 5\n").error().message, HasSubstr("traker"));
}

TEST_F(ConfigurationTest, PrintsWhatItReads) {
  radius_ = 7.5;
  const std::string printed = Configuration(program_).print();
  radius_ = 1.0;
  ASSERT_TRUE(read(printed)) << printed;
  EXPECT_EQ(radius_, 7.5);
}

TEST_F(ConfigurationTest, NeedsNoFileButFindsTheOneNamed) {
  EXPECT_TRUE(Configuration(program_).read(""));
  EXPECT_FALSE(Configuration(program_).read("/no/such/file.yaml"));
}

}  // namespace
}  // namespace eg::service
