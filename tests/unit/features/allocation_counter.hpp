#pragma once

#include <cstddef>

namespace eg::test {

/// What was taken from the heap: by operator new, whoever calls it, and for the pixels of cv::Mat.
struct Allocations {
  static constexpr std::size_t kLarge = 64 * 1024;  ///< bytes

  std::size_t count = 0;
  std::size_t large_count = 0;  ///< of kLarge bytes or more
  std::size_t large_bytes = 0;

  friend bool operator==(const Allocations&, const Allocations&) = default;
};

/// Counts in all threads of the program from its making on. Its source replaces operator new, so it belongs to one
/// program and not to a library.
class AllocationCounter {
 public:
  AllocationCounter();
  [[nodiscard]] Allocations counted() const;

 private:
  Allocations before_;
};

}  // namespace eg::test
