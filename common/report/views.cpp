#include "common/report/views.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/eval/view.hpp"
#include "common/report/html.hpp"

namespace eg::report {
namespace {

constexpr int kSize = 360;  // units of a square picture
constexpr int kMargin = 16;

/// From where one looks; angles as in eval::RenderOptions.
struct Side {
  const char* name;
  double azimuth;
  double elevation;
};

constexpr Side kTop{"from above", 0.0, std::numbers::pi / 2.0};
constexpr Side kFront{"from the front", 0.0, 0.0};
constexpr Side kSide{"from the side", std::numbers::pi / 2.0, 0.0};

eval::OrthographicView make_view(const Side& side, const Points& points, const eval::RenderOptions& options) {
  eval::OrthographicView view(options.up, options.ahead, side.azimuth, side.elevation, options.mirrored);
  view.fit({}, points, cv::Rect(kMargin, kMargin, kSize - 2 * kMargin, kSize - 2 * kMargin));
  return view;
}

std::string polyline(const Points& points, const eval::OrthographicView& view, const char* colour, double width) {
  std::string svg = fmt::format(
      R"(<polyline fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round" points=")", colour, width);
  for (const Eigen::Vector3d& point : points) {
    const cv::Point2d pixel = view.pixel(point);
    svg += fmt::format("{:.1f},{:.1f} ", pixel.x, pixel.y);
  }
  return svg.append("\"/>");
}

/// A bar of a round length of about a quarter of the picture.
std::string scale_bar(const eval::OrthographicView& view) {
  const double metres = kSize / 4.0 / view.pixels_per_metre();
  const double length = std::pow(10.0, std::floor(std::log10(metres)));
  const double round = metres >= 5.0 * length ? 5.0 * length : metres >= 2.0 * length ? 2.0 * length : length;
  return fmt::format(
      R"(<path d="M8 {0} h{1:.1f}" stroke='var(--soft)' stroke-width="2"/><text x="8" y="{2}">{3:g} m</text>)",
      kSize - 8, round * view.pixels_per_metre(), kSize - 13, round);
}

std::string open_svg() { return fmt::format(R"(<svg viewBox="0 0 {0} {0}" role="img">)", kSize); }

}  // namespace

std::string draw_trajectories(const Points& estimate, const Points& truth, const eval::RenderOptions& options) {
  if (estimate.empty()) return {};
  Points all = estimate;
  all.insert(all.end(), truth.begin(), truth.end());
  std::string html = "<div class=\"row\">\n";
  for (const Side& side : {kTop, kFront, kSide}) {
    const eval::OrthographicView view = make_view(side, all, options);
    html.append("<figure>").append(open_svg());
    if (!truth.empty()) html += polyline(truth, view, "var(--truth)", 5.0);
    html += polyline(estimate, view, "var(--estimate)", 1.4);
    html.append(scale_bar(view)).append("</svg><figcaption>").append(side.name).append("</figcaption></figure>\n");
  }
  return html.append("</div>\n");
}

std::string draw_graph(const Points& keyframes, std::span<const std::pair<std::size_t, std::size_t>> edges,
                       const std::string& colour, const std::string& caption, const eval::RenderOptions& options) {
  if (keyframes.empty()) return {};
  const eval::OrthographicView view = make_view(kTop, keyframes, options);
  // Many thousand edges would be one blot: the more there are, the fainter each.
  const double opacity = std::clamp(6.0 / std::sqrt(static_cast<double>(edges.size()) + 1.0), 0.08, 0.8);
  std::string svg = "<figure>";
  svg.append(open_svg()).append(fmt::format(R"(<path stroke="{}" stroke-opacity="{:.2f}" d=")", colour, opacity));
  for (const auto& [first, second] : edges) {
    const cv::Point2d a = view.pixel(keyframes[first]), b = view.pixel(keyframes[second]);
    svg += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", a.x, a.y, b.x, b.y);
  }
  svg += "\"/>";
  for (const Eigen::Vector3d& keyframe : keyframes) {
    const cv::Point2d pixel = view.pixel(keyframe);
    svg += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="2" fill='var(--text)'/>)", pixel.x, pixel.y);
  }
  return svg.append(scale_bar(view))
      .append("</svg><figcaption>")
      .append(escape(caption))
      .append("</figcaption></figure>\n");
}

}  // namespace eg::report
