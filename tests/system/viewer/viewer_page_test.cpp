#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/system/viewer/viewer_page.hpp"

/// The page watching all processes.
namespace eg {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using Names = std::vector<const char*>;

constexpr int kFrames = 60;

/// What two pages must agree in: everything but how they drew it.
const Names kEverything = {"sequence", "triangles", "tiles", "poses",  "keyframes",
                           "edges",    "points",    "lines", "planes", "landmarks"};
/// What a viewer that starts late can still learn.
const Names kLasting = {"triangles", "tiles", "keyframes", "edges", "points", "lines", "landmarks"};

class ViewerPage : public test::ViewerPage {
 protected:
  static json summary(test::BrowserPage& page) { return json::parse(page.evaluate("egraph.summary()")); }

  static json content(test::BrowserPage& page, const Names& names) {
    const json all = summary(page);
    json some;
    for (const char* name : names) some[name] = all.at(name);
    return some;
  }

  /// Whether a number of the page's summary reaches a value.
  static bool becomes(test::BrowserPage& page, const std::string& name, const json& value) {
    return page.wait_for("egraph.summary()." + name + " == " + value.dump(), 60s);
  }

  /// All services and the viewer, from the configuration that comes with them.
  std::vector<std::string> start_everything() const {
    setenv("EGRAPH_LCM_URL", lcm_url_.c_str(), 1);
    setenv("EGRAPH_HTTP", address_.c_str(), 1);
    setenv("EGRAPH_OUT", folder_.path().c_str(), 1);
    setenv("EGRAPH_DATASET", "synthetic:room", 1);
    setenv("EGRAPH_CONSUMERS", "tracker,mapper", 1);
    setenv("EGRAPH_LOCKSTEP", "1", 1);
    setenv("EGRAPH_FRAMES", std::to_string(kFrames).c_str(), 1);
    return {"--lone-ranger", EGRAPH_SOURCE_DIR "/procman/egraph.pmd", "run-and-view"};
  }

  static pid_t pid_of(const test::Program& system, const std::string& service) {
    const std::string output = system.output();
    const std::string announcement = service + " started as process ";
    return std::stoi(output.substr(output.rfind(announcement) + announcement.size()));
  }

  static void kill_and_await_return(const test::Program& system, const std::string& service) {
    const pid_t before = pid_of(system, service);
    kill(before, SIGKILL);
    for (int i = 0; i < 200 && pid_of(system, service) == before; ++i) std::this_thread::sleep_for(100ms);
    EXPECT_NE(pid_of(system, service), before) << service;
  }

  static void switch_layers_and_views(test::BrowserPage& page) {
    EXPECT_TRUE(page.wait_for("egraph.summary().settled"));  // while the view moves, there is less detail
    const std::string draw = "egraph.view.draw(), egraph.summary().drawnTriangles";
    const int drawn = std::stoi(page.evaluate(draw));
    page.evaluate("document.querySelector('input[name=mesh]').click()");
    EXPECT_LT(std::stoi(page.evaluate(draw)), drawn / 4);
    page.evaluate("document.querySelector('input[name=mesh]').click()");
    EXPECT_EQ(std::stoi(page.evaluate(draw)), drawn);
    for (const std::string mode : {"top", "follow", "orbit"}) {
      page.evaluate("document.querySelector('button[data-mode=" + mode + "]').click()");
      EXPECT_TRUE(page.wait_for("egraph.view.mode == '" + mode + "'"));
    }
  }

  static void click_on_a_keyframe(test::BrowserPage& page) {
    const json pixel = json::parse(page.evaluate("egraph.view.draw(), egraph.pixelOfKeyframe(0)"));
    page.click(pixel[0], pixel[1]);
    EXPECT_TRUE(page.wait_for("!document.getElementById('keyframe').hidden"));
    EXPECT_TRUE(page.wait_for("document.getElementById('keyframe-image').naturalWidth > 0"));
    EXPECT_NE(page.evaluate("document.querySelectorAll('#keyframe-directions li').length"), "0");
  }
};

TEST_F(ViewerPage, FollowsTheSystemAndHeals) {
  test::Browser browser;
  test::Program system("procman-sheriff", start_everything());
  ASSERT_TRUE(system.wait_for_output("in a browser")) << system.output();
  const auto page = open(browser);

  // It grows.
  ASSERT_TRUE(page->wait_for("egraph.summary().poses > 5 && egraph.summary().triangles > 0")) << system.output();
  const json early = summary(*page);
  EXPECT_EQ(early["state"], "tracking");
  EXPECT_TRUE(page->wait_for("egraph.summary().poses > " + early["poses"].dump() + " && egraph.summary().triangles > " +
                             early["triangles"].dump()));

  // Everything is there at the end, and a late page and a reloaded one show the same.
  ASSERT_TRUE(becomes(*page, "poses", kFrames));
  ASSERT_TRUE(becomes(*page, "image", kFrames - 1));
  ASSERT_TRUE(page->wait_for("egraph.summary().planes > 2 && egraph.summary().landmarks > 2"));
  EXPECT_TRUE(becomes(*page, "services.length", 6));
  std::this_thread::sleep_for(3s);  // the mapper's last tiles
  const json last = content(*page, kEverything);
  EXPECT_GT(int(last["edges"]), 0);
  const auto late = open(browser);
  EXPECT_TRUE(becomes(*late, "tiles", last["tiles"]));
  EXPECT_TRUE(becomes(*late, "planes", last["planes"]));
  EXPECT_EQ(content(*late, kEverything), last);
  page->reload();
  ASSERT_TRUE(becomes(*page, "tiles", last["tiles"]));
  EXPECT_TRUE(becomes(*page, "planes", last["planes"]));
  EXPECT_EQ(content(*page, kEverything), last);
  switch_layers_and_views(*page);
  click_on_a_keyframe(*page);
  page->screenshot(folder_.path() / "page.png");
  EXPECT_GT(test::file_bytes(folder_.path() / "page.png").size(), 50'000u);

  // A viewer that is killed comes back, and the page with it.
  kill(pid_of(system, "viewer"), SIGKILL);
  EXPECT_TRUE(becomes(*page, "poses", last["keyframes"])) << "the trajectory from keyframe to keyframe";
  for (const char* name : kLasting) EXPECT_TRUE(becomes(*page, name, last[name])) << name;

  // So does every service, and the page shows what it showed.
  for (const std::string service : {"feature_extractor", "egraph_server", "tracker", "mapper", "frame_source"}) {
    kill_and_await_return(system, service);
    EXPECT_TRUE(page->wait_for("egraph.summary().services.length == 6 && !egraph.summary().silent.length")) << service;
    for (const char* name : kLasting) EXPECT_TRUE(becomes(*page, name, last[name])) << name << " after " << service;
  }

  // One that hangs is seen to be silent, until it goes on.
  const pid_t hanging = pid_of(system, "feature_extractor");
  kill(hanging, SIGSTOP);
  EXPECT_TRUE(page->wait_for("egraph.summary().silent.includes('feature_extractor')"));
  EXPECT_TRUE(page->wait_for("document.querySelector('#health tr.silent')"));
  kill(hanging, SIGCONT);
  EXPECT_TRUE(page->wait_for("!document.querySelector('#health tr.silent')"));
  EXPECT_EQ(page->evaluate("egraph.errors"), "[]");
  system.send_signal(SIGINT);
  EXPECT_EQ(system.wait(60s), 0) << system.output();
}

TEST_F(ViewerPage, LeavesTheResultAsItIs) {
  const auto arguments = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> all = {"--dataset", "synthetic:room", "--frames",
                                    "30",        "--out",          (folder_.path() / name).string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  test::Browser browser;
  test::Program viewer("egraph-viewer", {"--lcm-url", lcm_url_, "--http", address_});
  ASSERT_TRUE(viewer.wait_for_output("in a browser")) << viewer.output();
  const auto first = open(browser);
  const auto second = open(browser);
  test::Program alone("egraph-run", arguments("alone", {}));
  test::Program watched("egraph-run", arguments("watched", {"--lcm-url", lcm_url_, "--report"}));
  ASSERT_EQ(watched.wait(), 0) << watched.output();
  ASSERT_EQ(alone.wait(), 0) << alone.output();
  EXPECT_TRUE(becomes(*first, "poses", 30));
  EXPECT_TRUE(becomes(*second, "poses", 30));
  for (const char* name : {"trajectory.txt", "states.csv", "keyframes.txt", "egraph.json", "map.ply", "mesh.ply"}) {
    const std::string bytes = test::file_bytes(folder_.path() / "alone" / name);
    EXPECT_FALSE(bytes.empty()) << name;
    EXPECT_TRUE(bytes == test::file_bytes(folder_.path() / "watched" / name)) << name;
  }

  // What was in force is a configuration itself.
  const std::string settings = test::file_bytes(folder_.path() / "watched/settings.yaml");
  for (const char* service : {"frame_source:", "feature_extractor:", "tracker:", "egraph_server:", "mapper:"}) {
    EXPECT_NE(settings.find(service), std::string::npos) << service;
  }
  test::Program understood("egraph-tracker",
                           {"--print-config", "--config", (folder_.path() / "watched/settings.yaml").string()});
  EXPECT_EQ(understood.wait(20s), 0) << understood.output();

  // The report is a page without a server, also on a phone.
  const auto report = browser.open("file://" + (folder_.path() / "watched/report.html").string());
  report->resize(390, 844);
  EXPECT_TRUE(report->wait_for("document.readyState == 'complete' && document.images.length == 4"));
  EXPECT_EQ(report->evaluate("[...document.images].every((image) => image.naturalWidth > 0)"), "true");
  EXPECT_EQ(report->evaluate("document.querySelectorAll('svg').length"), "8");
  EXPECT_EQ(report->evaluate("document.documentElement.scrollWidth"), "390");
  const std::string loaded =
      "performance.getEntriesByType('resource').filter((r) => !r.name.startsWith('data:')).length";
  EXPECT_EQ(report->evaluate(loaded), "0");
  viewer.send_signal(SIGINT);
  EXPECT_EQ(viewer.wait(20s), 0);
}

}  // namespace
}  // namespace eg
