#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace eg::io {

/// Indices of one colour and one depth image that belong together.
struct ImagePair {
  std::size_t colour = 0;
  std::size_t depth = 0;
};

/// Pairs two strictly increasing series of time stamps (microseconds): closest pairs first, each image in at most one
/// pair, no pair further apart than `max_difference`, and order preserved (pairs do not cross). Of equally close pairs
/// the earlier wins. The result is in increasing time.
std::vector<ImagePair> associate(std::span<const std::int64_t> colour_utimes,
                                 std::span<const std::int64_t> depth_utimes, std::int64_t max_difference);

}  // namespace eg::io
