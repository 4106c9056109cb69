#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/program.hpp"

namespace eg {
namespace {

/// What egraph-eval ablation switches off must exist under that name.
TEST(Ablation, EveryConfigurationIsUnderstoodByItsService) {
  int configurations = 0;
  for (const auto& entry : std::filesystem::directory_iterator(EGRAPH_SOURCE_DIR "/tests/bench/ablation")) {
    for (const char* service : {"egraph-tracker", "egraph-server"}) {
      test::Program program(service, {"--config", entry.path().string(), "--print-config"});
      EXPECT_EQ(program.wait(), 0) << entry.path() << ": " << program.output();
    }
    ++configurations;
  }
  EXPECT_GE(configurations, 5);
}

}  // namespace
}  // namespace eg
