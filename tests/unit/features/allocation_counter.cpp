#include "tests/unit/features/allocation_counter.hpp"

#include <atomic>
#include <cstdlib>
#include <new>
#include <opencv2/core/mat.hpp>

namespace eg::test {
namespace {

std::atomic<std::size_t> count, large_count, large_bytes;

void note(std::size_t size) {
  ++count;
  if (size < Allocations::kLarge) return;
  ++large_count;
  large_bytes += size;
}

Allocations total() { return {count, large_count, large_bytes}; }

/// OpenCV's own allocator, with a tally.
class CountingMatAllocator : public cv::MatAllocator {
 public:
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, std::size_t* step, cv::AccessFlag flags,
                         cv::UMatUsageFlags usage) const override {
    cv::UMatData* made = cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, flags, usage);
    if (data == nullptr) note(made->size);
    return made;
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* data) const override { cv::Mat::getStdAllocator()->deallocate(data); }
};

}  // namespace

AllocationCounter::AllocationCounter() {
  static CountingMatAllocator allocator;
  cv::Mat::setDefaultAllocator(&allocator);
  before_ = total();
}

Allocations AllocationCounter::counted() const {
  const Allocations now = total();
  return {now.count - before_.count, now.large_count - before_.large_count, now.large_bytes - before_.large_bytes};
}

}  // namespace eg::test

void* operator new(std::size_t size) {
  eg::test::note(size);
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
