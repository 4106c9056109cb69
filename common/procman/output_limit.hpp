#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>

namespace eg::procman {

/// Bounds what one command's output may take of the network. More than any log needs; a command that prints without end
/// must not drown the others.
class OutputLimit {
 public:
  /// The part of `bytes` that may still be sent in this period.
  std::string_view admit(std::string_view bytes) {
    const std::string_view admitted = bytes.substr(0, std::min(bytes.size(), kBytesPerPeriod - sent_));
    sent_ += admitted.size();
    left_out_ += bytes.size() - admitted.size();
    return admitted;
  }

  /// Begins a new period, a second. Returns how many bytes were left out in the last one.
  std::size_t renew() {
    sent_ = 0;
    return std::exchange(left_out_, 0);
  }

 private:
  static constexpr std::size_t kBytesPerPeriod = 128 << 10;

  std::size_t sent_ = 0;
  std::size_t left_out_ = 0;
};

}  // namespace eg::procman
