#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace eg::mapping {

/// Numbers of leaves or tiles, packed into 20 bits per axis, which at the smallest voxel size still spans kilometres.
/// Packed numbers are in lexicographic order.
inline constexpr int kAxisBits = 20;
inline constexpr std::int64_t kAxisOffset = std::int64_t{1} << (kAxisBits - 1);

inline std::uint64_t pack(const Eigen::Vector3i& number) {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) key = key << kAxisBits | static_cast<std::uint64_t>(number[axis] + kAxisOffset);
  return key;
}

inline std::vector<Eigen::Vector3i> unpacked(const std::vector<std::uint64_t>& keys) {
  std::vector<Eigen::Vector3i> numbers(keys.size());
  std::transform(keys.begin(), keys.end(), numbers.begin(), [](std::uint64_t key) {
    Eigen::Vector3i number;
    for (int axis = 2; axis >= 0; --axis, key >>= kAxisBits) {
      number[axis] = static_cast<int>(static_cast<std::int64_t>(key & ((1U << kAxisBits) - 1)) - kAxisOffset);
    }
    return number;
  });
  return numbers;
}

/// Collects numbers that come many times in short succession. Most repetitions are kept out by a small cache.
class NumberList {
 public:
  NumberList() { recent_.fill(std::numeric_limits<std::uint64_t>::max()); }

  void add(const Eigen::Vector3i& number) {
    const std::uint64_t key = pack(number);
    std::uint64_t& slot = recent_[(key ^ key >> 17 ^ key >> 34) % recent_.size()];
    if (slot == key) return;
    slot = key;
    keys_.push_back(key);
  }

  /// Packed, ascending, each once.
  [[nodiscard]] std::vector<std::uint64_t> sorted() && {
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    return std::move(keys_);
  }

 private:
  std::array<std::uint64_t, 1024> recent_{};
  std::vector<std::uint64_t> keys_;
};

}  // namespace eg::mapping
