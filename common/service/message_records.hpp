#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/messages/codec.hpp"

/// Messages as the bytes of files: records of journals (common/io/journal.hpp), compressed images.
namespace eg::service {

inline std::string_view text_of(const messages::Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
inline messages::ByteView bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Stands for the types of messages that the records of a file hold, in its header.
template <typename... Messages>
std::uint64_t schema_of() {
  const auto fingerprint = [](const messages::Bytes& message) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof value; ++i) value = value << 8U | message[i];
    return value;
  };
  return (fingerprint(messages::encode(Messages{})) ^ ...);
}

}  // namespace eg::service
