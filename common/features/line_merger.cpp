#include "common/features/line_merger.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace eg::features {
namespace {

/// A total order, so that the result does not depend on the detector's.
bool longer(const Segment& a, const Segment& b) {
  return std::tuple(-a.length(), a.start.y(), a.start.x(), a.end.y(), a.end.x()) <
         std::tuple(-b.length(), b.start.y(), b.start.x(), b.end.y(), b.end.x());
}

double offset_from(const Segment& line, const Eigen::Vector2d& point) {
  return std::abs(line.normal().dot(point - line.start));
}

/// `first` and `second`, where `second` starts near or after the end of `first`, as one segment through their outer
/// ends.
std::optional<Segment> join_in_order(const Segment& first, const Segment& second, const LineMergerOptions& options) {
  const double shorter = std::min(first.length(), second.length());
  const Eigen::Vector2d gap = second.start - first.end;
  const double gap_along = first.unit().dot(gap);
  if (gap_along > std::min(options.max_gap, options.max_gap_share * shorter)) return std::nullopt;
  if (gap_along < -0.5 * shorter) return std::nullopt;

  const Segment joined{first.start, second.end, std::min(first.sigma, second.sigma)};
  const bool straight =
      offset_from(joined, first.end) <= options.max_offset && offset_from(joined, second.start) <= options.max_offset;
  return straight ? std::optional(joined) : std::nullopt;
}

std::optional<Segment> join(const Segment& a, const Segment& b, const LineMergerOptions& options) {
  if (a.unit().dot(b.unit()) < 0.9) return std::nullopt;
  if (offset_from(a, b.start) > 2.0 * options.max_offset + 2.0 ||
      offset_from(a, b.end) > 2.0 * options.max_offset + 2.0) {
    return std::nullopt;
  }
  const bool a_first = a.unit().dot(b.at(0.5) - a.at(0.5)) > 0.0;
  const auto joined = a_first ? join_in_order(a, b, options) : join_in_order(b, a, options);
  return joined && joined->length() > std::max(a.length(), b.length()) ? joined : std::nullopt;
}

}  // namespace

std::vector<Segment> merge_collinear(std::vector<Segment> segments, const LineMergerOptions& options) {
  std::sort(segments.begin(), segments.end(), longer);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = i + 1; j < segments.size();) {
      if (const auto joined = join(segments[i], segments[j], options)) {
        segments[i] = *joined;
        segments.erase(segments.begin() + static_cast<std::ptrdiff_t>(j));
        j = i + 1;  // the longer segment may reach pieces that it could not reach before
      } else {
        ++j;
      }
    }
  }
  std::sort(segments.begin(), segments.end(), longer);
  return segments;
}

}  // namespace eg::features
