#include "common/report/run_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/report/html.hpp"

namespace eg::report {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A circle of 2 m across; the truth is the same, elsewhere, with one frame 10 mm off.
RunResults some_run() {
  RunResults run;
  run.input = "a <recording> & more";
  run.mode = "lockstep";
  run.outcome = "complete";
  run.frames = run.frames_with_pose = 100;
  for (int i = 0; i < 100; ++i) {
    const double angle = 0.0628 * i;
    geometry::StampedPose pose{i / 30.0, {Eigen::Matrix3d::Identity(), {std::cos(angle), 0.0, std::sin(angle)}}};
    run.estimate.push_back(pose);
    pose.world_from_camera.translation += Eigen::Vector3d(5.0, 0.0, 0.0);
    run.truth.push_back(pose);
    run.states.push_back({pose.time_s, i < 90 ? "tracking" : "lost"});
  }
  run.truth[50].world_from_camera.translation.y() += 0.01;
  for (int id = 0; id < 3; ++id) {
    egraph::KeyframeNode node;
    node.id = {id};
    node.world_from_camera = run.estimate[static_cast<std::size_t>(30 * id)].world_from_camera;
    run.graph.keyframes.push_back(node);
  }
  run.graph.edges = {{{0}, {1}, {}}, {{0}, {2}, {}}};
  run.graph.covisibility = {{{0}, {1}, 20}, {{0}, {2}, 10}};
  run.services.push_back({"tracker", 100, 1, 2, 3.0, 4.0, 5.0, 6.0, 1.5, 64'000'000});
  run.settings = "tracker: {}";
  return run;
}

TEST(RunReport, SaysWhatTheRunWas) {
  const std::string html = write_report(some_run());
  EXPECT_THAT(html, HasSubstr("a &lt;recording&gt; &amp; more"));
  EXPECT_THAT(html, HasSubstr("<b>1.0 mm</b>"));  // 10 mm in one of 100 frames
  EXPECT_THAT(html, HasSubstr("100 of 100"));
  EXPECT_THAT(html, HasSubstr("E-Graph: 2 edges between 3 keyframes"));
  EXPECT_THAT(html, HasSubstr("covisibility: 1 edges (15 or more shared features)"));
  EXPECT_THAT(html, HasSubstr("tracking 90"));
  EXPECT_THAT(html, HasSubstr("lost 10"));
  EXPECT_THAT(html, HasSubstr("<td>15.0</td><td>64</td>"));  // 1.5 s over 100 messages, 64 MB
  EXPECT_THAT(html, HasSubstr("from the side"));
  EXPECT_THAT(html, HasSubstr("name=\"viewport\""));
}

TEST(RunReport, ShowsNoTruthOfBeforeOrAfterTheRun) {
  RunResults run = some_run();
  const std::string html = write_report(run);
  geometry::StampedPose far = run.truth.back();
  far.time_s += 10.0;
  far.world_from_camera.translation.x() += 100.0;
  run.truth.push_back(far);
  EXPECT_EQ(write_report(run), html);
}

TEST(RunReport, LoadsNothing) {
  const std::string html = write_report(some_run());
  for (const char* reference : {"http:", "https:", "<script", "<link", "url(", "src=\"/", "@import"}) {
    EXPECT_THAT(html, Not(HasSubstr(reference)));
  }
}

TEST(RunReport, DescribesARunThatCameToNothing) {
  RunResults run;
  run.outcome = "failed: the camera went away";
  const std::string html = write_report(run);
  EXPECT_THAT(html, HasSubstr("failed: the camera went away"));
  EXPECT_THAT(html, Not(HasSubstr("Trajectory")));
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(RunReport, StaysSmallWhenTheRunIsLong) {
  RunResults run = some_run();
  const auto first = run.estimate;
  for (int lap = 1; lap < 100; ++lap) {
    for (std::size_t i = 0; i < first.size(); ++i) {
      for (auto* trajectory : {&run.estimate, &run.truth}) {
        trajectory->push_back((*trajectory)[i]);
        trajectory->back().time_s += lap * 10.0;
      }
    }
  }
  EXPECT_LT(write_report(run).size(), 1'500'000u);
}

TEST(Html, EncodesImagesAsRfc4648Says) {
  const auto encoded = [](const std::string& text) {
    return embedded_png({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "");
  };
  EXPECT_THAT(encoded("foobar"), HasSubstr("base64,Zm9vYmFy\""));
  EXPECT_THAT(encoded("fooba"), HasSubstr("base64,Zm9vYmE=\""));
  EXPECT_THAT(encoded("foob"), HasSubstr("base64,Zm9vYg==\""));
}

}  // namespace
}  // namespace eg::report
