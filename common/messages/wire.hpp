#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

#include "common/base/check.hpp"
#include "common/base/result.hpp"
#include "common/messages/codec.hpp"

/// Between bytes and the classes that lcm-gen makes. Every message type of the project is laid out so that its size can
/// be verified before anything is allocated, because the generated decoders resize first and check afterwards: behind
/// the fingerprint come the counts of all arrays, then the fields of fixed size, then the arrays, whose elements have a
/// fixed size, and the strings at the very end.
namespace eg::messages {

/// A count at the beginning of a message.
struct ArrayCount {
  const char* name;           ///< of the count's field
  std::int64_t maximum;       ///< largest count allowed
  std::size_t element_bytes;  ///< encoded size of one element, of all arrays with this count together
};

/// A string at the end of a message.
struct Text {
  const char* name;
  std::size_t maximum;  ///< characters
};

/// What a message type looks like as bytes.
struct Layout {
  const char* type;           ///< name of the LCM type
  std::uint64_t fingerprint;  ///< its first eight bytes
  std::size_t fixed_bytes;    ///< size when all arrays and strings are empty
  std::initializer_list<ArrayCount> counts;
  std::initializer_list<Text> texts;
};

/// Whether `bytes` is one whole message of this type: fingerprint, counts within bounds, strings that are short,
/// printable and ended properly, and exactly the size that all of them add up to. Reads nothing else.
base::Status check_layout(ByteView bytes, const Layout& layout);

/// The text as a message may carry it: at most `maximum` bytes of UTF-8, control characters replaced by spaces.
std::string printable(std::string_view text, std::size_t maximum);

/// Encoded size of an LCM type of fixed size inside another one.
template <typename Wire>
std::size_t wire_size() {
  return static_cast<std::size_t>(Wire{}._getEncodedSizeNoHash());
}

template <typename Wire>
Bytes encode_wire(const Wire& wire) {
  Bytes bytes(static_cast<std::size_t>(wire.getEncodedSize()));
  const int written = wire.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  EG_CHECK(written == static_cast<int>(bytes.size()), "the buffer has the size that the message asked for");
  return bytes;
}

/// The generated class's content of a message whose layout is right.
template <typename Wire>
base::Result<Wire> decode_wire(ByteView bytes, std::initializer_list<ArrayCount> counts,
                               std::initializer_list<Text> texts) {
  Wire wire{};
  const Layout layout{Wire::getTypeName(), static_cast<std::uint64_t>(Wire::getHash()),
                      static_cast<std::size_t>(wire.getEncodedSize()), counts, texts};
  if (const auto status = check_layout(bytes, layout); !status) return tl::make_unexpected(status.error());
  if (wire.decode(bytes.data(), 0, static_cast<int>(bytes.size())) != static_cast<int>(bytes.size())) {
    return base::fail("the message is damaged");
  }
  return wire;
}

}  // namespace eg::messages
