#include "common/report/plots.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/report/html.hpp"

namespace eg::report {
namespace {

constexpr double kWidth = 640.0;  // units of the picture
constexpr double kHeight = 200.0;
constexpr double kLeft = 52.0;
constexpr double kBottom = 24.0;
constexpr double kTop = 12.0;
constexpr std::size_t kColumns = 580;  ///< more points than units do not show

/// The smallest of 1, 2, 5 times a power of ten that is at least `value`.
double round_up(double value) {
  if (value <= 0.0) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= value) return factor * power;
  }
  return 10.0 * power;
}

/// Of each of the columns the sample with the largest value.
TimeSeries thin(const TimeSeries& series) {
  if (series.values.size() <= kColumns) return series;
  TimeSeries thinned;
  for (std::size_t column = 0; column < kColumns; ++column) {
    const auto begin = series.values.begin() + static_cast<std::ptrdiff_t>(column * series.values.size() / kColumns);
    const auto end =
        series.values.begin() + static_cast<std::ptrdiff_t>((column + 1) * series.values.size() / kColumns);
    const auto largest = std::max_element(begin, end);
    thinned.times.push_back(series.times[static_cast<std::size_t>(largest - series.values.begin())]);
    thinned.values.push_back(*largest);
  }
  return thinned;
}

const char* colour_of(const std::string& state) {
  static const std::map<std::string, const char*> kColours = {{"tracking", "var(--good)"},
                                                              {"relocalised", "var(--estimate)"},
                                                              {"rotation_only", "var(--warn)"},
                                                              {"initialising", "var(--warn)"},
                                                              {"lost", "var(--bad)"}};
  const auto known = kColours.find(state);
  return known == kColours.end() ? "var(--soft)" : known->second;
}

std::string open_svg(double height) {
  return fmt::format(R"(<svg class="plot" viewBox="0 0 {:.0f} {:.0f}" role="img">)", kWidth, height);
}

std::string legend(const std::vector<StateSample>& states) {
  std::map<std::string, int> counts;
  for (const StateSample& sample : states) ++counts[sample.state];
  std::string html;
  for (const auto& [state, count] : counts) {
    html += fmt::format(R"(<span style="color:{}">■</span> {} {} &nbsp; )", colour_of(state), escape(state), count);
  }
  return html;
}

}  // namespace

std::string plot_over_time(const TimeSeries& all, const std::string& label) {
  if (all.values.empty()) return {};
  const TimeSeries series = thin(all);
  const double begin = series.times.front();
  const double seconds = std::max(series.times.back() - begin, 1e-9);
  const double top = round_up(*std::max_element(series.values.begin(), series.values.end()));
  const auto x = [&](double time) { return kLeft + (time - begin) / seconds * (kWidth - kLeft - 8.0); };
  const auto y = [&](double value) { return kHeight - kBottom - value / top * (kHeight - kBottom - kTop); };
  std::string svg = "<figure>";
  svg.append(open_svg(kHeight));
  for (const double share : {0.0, 0.5, 1.0}) {
    svg += fmt::format(R"(<line x1="{0:.1f}" x2="{1:.1f}" y1="{2:.1f}" y2="{2:.1f}" stroke='var(--line)'/>)"
                       R"(<text x="{3:.1f}" y="{4:.1f}" text-anchor="end">{5:g}</text>)",
                       kLeft, kWidth - 8.0, y(share * top), kLeft - 6.0, y(share * top) + 4.0, share * top);
  }
  svg += fmt::format(
      R"(<text x="{:.1f}" y="{:.1f}">0 s</text><text x="{:.1f}" y="{:.1f}" text-anchor="end">{:.1f} s</text>)", kLeft,
      kHeight - 6.0, kWidth - 8.0, kHeight - 6.0, seconds);
  svg += R"(<polyline fill="none" stroke='var(--estimate)' stroke-width="1.5" stroke-linejoin="round" points=")";
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    svg += fmt::format("{:.1f},{:.1f} ", x(series.times[i]), y(series.values[i]));
  }
  return svg.append("\"/></svg><figcaption>").append(escape(label)).append("</figcaption></figure>\n");
}

std::string plot_states(const std::vector<StateSample>& states) {
  if (states.empty()) return {};
  constexpr double kBar = 28.0;
  std::string svg = "<figure>";
  svg.append(open_svg(kBar));
  const double width = kWidth / static_cast<double>(states.size());
  for (std::size_t i = 0; i < states.size();) {
    std::size_t end = i;
    while (end < states.size() && states[end].state == states[i].state) ++end;
    svg += fmt::format(R"(<rect x="{:.2f}" y="0" width="{:.2f}" height="{:.0f}" fill="{}"/>)",
                       static_cast<double>(i) * width, static_cast<double>(end - i) * width, kBar,
                       colour_of(states[i].state));
    i = end;
  }
  return svg.append("</svg><figcaption>frame by frame: ").append(legend(states)).append("</figcaption></figure>\n");
}

}  // namespace eg::report
