#pragma once

#include <array>
#include <istream>
#include <string>

namespace eg::base {

/// All that is left in a stream. If that cannot be read, stream.bad() says so; an iterator over the stream's buffer
/// would throw instead (a folder opened as a file, a process that ends while its /proc is read).
inline std::string read_stream(std::istream& stream) {
  std::string text;
  std::array<char, 4096> piece{};
  do {
    stream.read(piece.data(), piece.size());
    text.append(piece.data(), static_cast<std::size_t>(stream.gcount()));
  } while (stream.good());
  return text;
}

}  // namespace eg::base
