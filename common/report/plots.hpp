#pragma once

#include <string>
#include <vector>

/// Plots as SVG, in the colours of the page (html.hpp).
namespace eg::report {

/// A value over time.
struct TimeSeries {
  std::vector<double> times;   ///< seconds
  std::vector<double> values;  ///< one per time, at least 0
};

/// A curve from 0 upwards; `label` with its unit. Long series are thinned to what the eye resolves, keeping each
/// interval's largest value.
std::string plot_over_time(const TimeSeries& series, const std::string& label);

/// A frame's tracking state.
struct StateSample {
  double time_s = 0.0;
  std::string state;  ///< as in states.csv
};

/// A bar whose colour says in which state each frame was, with a legend of how many frames were in each.
std::string plot_states(const std::vector<StateSample>& states);

}  // namespace eg::report
