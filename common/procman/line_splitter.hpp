#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace eg::procman {

/// Makes lines of output that comes in pieces.
class LineSplitter {
 public:
  using OnLine = std::function<void(const std::string& line)>;  ///< without its end

  void add(std::string_view bytes, const OnLine& on_line) {
    for (const char c : bytes) {
      if (c != '\n') line_ += c;
      if (c == '\n' || line_.size() == kLongestLine) finish(on_line);
    }
  }

  /// The rest, when nothing more comes.
  void flush(const OnLine& on_line) {
    if (!line_.empty()) finish(on_line);
  }

 private:
  static constexpr std::size_t kLongestLine = 4096;  ///< longer ones are passed on in pieces

  void finish(const OnLine& on_line) {
    on_line(line_);
    line_.clear();
  }

  std::string line_;
};

}  // namespace eg::procman
