#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "common/base/result.hpp"
#include "common/procman/protocol.hpp"

/// LCM's encoding of fields: integers big-endian, floats as their bits, a string as its length with the closing zero,
/// its bytes and the zero. Not lcm-gen's classes, because their decoders allocate what a count asks for before they
/// look whether the bytes are there, and because a visitor that writes and reads describes each type once.
namespace eg::procman {

template <typename T>
concept WireNumber = std::integral<T> || std::same_as<T, float>;

/// Appends fields to a message.
class WireWriter {
 public:
  explicit WireWriter(std::uint64_t fingerprint) { append(fingerprint); }

  template <WireNumber T>
  void field(const char* /*name*/, const T& value) {
    if constexpr (std::same_as<T, float>) {
      append(std::bit_cast<std::uint32_t>(value));
    } else if constexpr (std::same_as<T, bool>) {
      append(static_cast<std::uint8_t>(value));
    } else {
      append(static_cast<std::make_unsigned_t<T>>(value));
    }
  }

  void field(const char* name, const std::string& text);

  template <typename Item, typename Visit>
  void list(const char* name, const std::vector<Item>& items, Visit visit) {
    field(name, static_cast<std::int32_t>(items.size()));
    for (const Item& item : items) visit(*this, item);
  }

  void options(const ProtocolOptions& options);

  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  template <typename Unsigned>
  void append(Unsigned bits) {
    for (int shift = 8 * static_cast<int>(sizeof bits) - 8; shift >= 0; shift -= 8) {
      bytes_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(bits) >> static_cast<unsigned>(shift)));
    }
  }

  std::vector<std::uint8_t> bytes_;
};

/// Takes fields from a message. After the first mistake, which status() tells, it takes no more.
class WireReader {
 public:
  WireReader(std::span<const std::uint8_t> bytes, std::uint64_t fingerprint);

  template <WireNumber T>
  void field(const char* name, T& value) {
    const std::uint64_t bits = take_bits(name, sizeof value);
    if constexpr (std::same_as<T, float>) {
      value = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    } else {
      value = static_cast<T>(bits);
    }
  }

  void field(const char* name, std::string& text);

  /// Items are made one by one as their bytes turn up: a count alone allocates nothing.
  template <typename Item, typename Visit>
  void list(const char* name, std::vector<Item>& items, Visit visit) {
    for (std::int32_t left = take_count(name); left > 0 && ok(); --left) visit(*this, items.emplace_back());
  }

  void options(ProtocolOptions& options);

  void require(bool condition, const char* name, const char* complaint);

  [[nodiscard]] bool ok() const { return error_.empty(); }

  /// The first mistake; also that bytes are left over.
  [[nodiscard]] base::Status status() const;

 private:
  std::uint64_t take_bits(const char* name, std::size_t size);
  std::int32_t take_count(const char* name);
  void fail(const char* name, const char* complaint);

  std::span<const std::uint8_t> bytes_;
  std::string error_;
};

}  // namespace eg::procman
