#pragma once

#include <set>
#include <utility>

#include "services/frame_source/frame_input.hpp"

namespace eg::test {

/// Tiny frames at 10 Hz, of which some cannot be read. Every frame's pixels hold its index.
class FakeInput : public services::FrameInput {
 public:
  explicit FakeInput(std::int64_t size, std::set<std::int64_t> unreadable = {})
      : size_(size), unreadable_(std::move(unreadable)) {}

  [[nodiscard]] std::int64_t size() const override { return size_; }
  [[nodiscard]] std::int64_t utime(std::int64_t index) const override { return 5'000'000 + 100'000 * index; }
  [[nodiscard]] base::Result<services::SourceFrame> read(std::int64_t index) const override {
    if (unreadable_.contains(index)) return base::fail("image " + std::to_string(index) + " is cut short");
    const geometry::CameraModel camera{"tiny", 16, 12, 20, 20, 7.5, 5.5, {}, 1000, 10};
    return messages::compress({{0, 0, utime(index)},
                               camera,
                               cv::Mat(12, 16, CV_8UC3, cv::Scalar::all(100)),
                               cv::Mat(12, 16, CV_16UC1, cv::Scalar(static_cast<double>(1 + index)))});
  }
  [[nodiscard]] std::string description() const override { return "fake"; }

  /// The index of the frame that was read.
  static std::int64_t index_of(const services::SourceFrame& frame) {
    return index_of(messages::decompress(std::get<messages::CompressedFrame>(frame)).value());
  }
  static std::int64_t index_of(const image::RgbdFrame& frame) { return frame.depth.at<std::uint16_t>(0, 0) - 1; }

 private:
  std::int64_t size_;
  std::set<std::int64_t> unreadable_;
};

}  // namespace eg::test
