#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/system/viewer/viewer_page.hpp"

/// The page by itself, and how a run serves it.
namespace eg {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
class ViewerAlone : public test::ViewerPage {};

/// Two neighbouring tiles of hilly ground as the viewer sends them, each in numbers of its own bounds, in two coarser
/// levels of detail: where on their common face each still has vertices (z and height, tenths of millimetres).
constexpr const char* kCommonFace = R"(import('./simplify.js').then(({simplify}) => {
  const edge = 0.64, cells = 32, levels = [];
  const height = (x, z) => 0.2 + 0.1 * Math.sin(4 * x) * Math.cos(5 * z);
  const makeTile = (number) => {
    const vertices = [], indices = [];
    for (let row = 0; row <= cells; ++row) for (let column = 0; column <= cells; ++column) {
      const x = edge * (number + column / cells), z = edge * row / cells;
      vertices.push([x, height(x, z), z]);
      if (row === cells || column === cells) continue;
      const corner = row * (cells + 1) + column, below = corner + cells + 1;
      indices.push(corner, corner + 1, below, corner + 1, below + 1, below);
    }
    const low = [0, 1, 2].map((axis) => Math.min(...vertices.map((v) => v[axis])));
    const high = [0, 1, 2].map((axis) => Math.max(...vertices.map((v) => v[axis])));
    const step = Math.max(...high.map((x, axis) => x - low[axis])) / 65535;
    const positions = new Uint16Array(vertices.flatMap((v) => [...v.map((x, axis) => Math.round((x - low[axis]) / step)), 0]));
    return {positions, indices: new Uint16Array(indices), step, edge, low: [low[0] - number * edge, low[1], low[2]], vertices};
  };
  for (const coarse of [16, 7]) {
    levels.push([0, 1].map((number) => {
      const tile = makeTile(number);
      const used = new Set(simplify(tile, coarse));
      const onFace = [...used].map((i) => tile.vertices[i]).filter((v) => Math.abs(v[0] - edge) < 1e-6);
      return onFace.map((v) => [Math.round(1e4 * v[2]), Math.round(1e4 * v[1])]).sort((a, b) => a[0] - b[0]);
    }));
  }
  return levels;
}))";

TEST_F(ViewerAlone, LeavesNoGapsBetweenTilesInCoarserLevelsOfDetail) {
  test::Browser browser;
  test::Program viewer("egraph-viewer", {"--lcm-url", lcm_url_, "--http", address_});
  ASSERT_TRUE(viewer.wait_for_output("in a browser")) << viewer.output();
  const json levels = json::parse(open(browser)->evaluate(kCommonFace));
  ASSERT_EQ(levels.size(), 2u);
  for (const json& level : levels) {
    EXPECT_EQ(level[0], level[1]) << "the two tiles end in different lines";
    EXPECT_LT(level[0].size(), 33u) << "all vertices are left";
  }
  EXPECT_GT(levels[0][0].size(), levels[1][0].size());
  EXPECT_GE(levels[1][0].size(), 7u);
  viewer.send_signal(SIGINT);
  EXPECT_EQ(viewer.wait(20s), 0);
}

/// A terminal on this process's standard input, which programs that it starts inherit.
class TerminalAsInput {
 public:
  TerminalAsInput() : master_(posix_openpt(O_RDWR | O_NOCTTY)), before_(dup(STDIN_FILENO)) {
    EXPECT_TRUE(grantpt(master_) == 0 && unlockpt(master_) == 0);
    const int terminal = ::open(ptsname(master_), O_RDWR | O_NOCTTY);
    EXPECT_EQ(dup2(terminal, STDIN_FILENO), STDIN_FILENO);
    close(terminal);
  }
  ~TerminalAsInput() {
    dup2(before_, STDIN_FILENO);
    close(before_);
    close(master_);
  }
  TerminalAsInput(const TerminalAsInput&) = delete;
  TerminalAsInput& operator=(const TerminalAsInput&) = delete;

 private:
  int master_;
  int before_;
};

TEST_F(ViewerAlone, IsServedByARunUntilSomebodyAtTheTerminalHasSeenIt) {
  const std::vector<std::string> arguments = {"--dataset", "synthetic:corner",      "--frames", "10",
                                              "--out",     folder_.path().string(), "--view",   "--http",
                                              address_};
  const TerminalAsInput terminal;
  test::Browser browser;
  test::Program run("egraph-run", arguments);
  ASSERT_TRUE(run.wait_for_output("Watch it: open http://" + address_ + " in a browser")) << run.output();
  ASSERT_TRUE(run.wait_for_output("The page stays at http://" + address_ + " until Ctrl-C")) << run.output();
  const auto page = open(browser);
  EXPECT_TRUE(page->wait_for("egraph.summary().keyframes > 0 && egraph.summary().triangles > 0"));

  // Where somebody serves already, nobody else can.
  std::vector<std::string> others = arguments;
  others[5] = (folder_.path() / "other").string();
  test::Program other("egraph-run", others);
  EXPECT_EQ(other.wait(20s), 1);
  EXPECT_THAT(other.output(), testing::HasSubstr("browsers cannot be served at " + address_));
  run.send_signal(SIGINT);
  EXPECT_EQ(run.wait(60s), 0) << run.output();
  EXPECT_THAT(run.output(), testing::HasSubstr("ATE"));
}

}  // namespace
}  // namespace eg
