#include "common/procman/wire.hpp"

#include <algorithm>

namespace eg::procman {

void WireWriter::field(const char* name, const std::string& text) {
  // A zero would end the string at the receiver.
  const std::string whole = text.substr(0, text.find('\0'));
  field(name, static_cast<std::int32_t>(whole.size() + 1));
  bytes_.insert(bytes_.end(), whole.begin(), whole.end());
  bytes_.push_back(0);
}

void WireWriter::options(const ProtocolOptions& options) {
  field("num_options", static_cast<std::int32_t>(options.size()));
  for (const auto& [name, value] : options) field("option_names", name);
  for (const auto& [name, value] : options) field("option_values", value);
}

WireReader::WireReader(std::span<const std::uint8_t> bytes, std::uint64_t fingerprint) : bytes_(bytes) {
  const std::uint64_t found = take_bits("fingerprint", sizeof fingerprint);
  require(found == fingerprint, "fingerprint", "is of another type");
}

void WireReader::field(const char* name, std::string& text) {
  const std::int32_t size = take_count(name);
  if (!ok()) return;
  const auto length = static_cast<std::size_t>(size);
  require(length >= 1 && length <= bytes_.size() && bytes_[length - 1] == 0, name, "is no whole string");
  if (!ok()) return;
  const auto characters = bytes_.first(length - 1);
  text.assign(characters.begin(), characters.end());
  bytes_ = bytes_.subspan(length);
}

void WireReader::options(ProtocolOptions& options) {
  for (std::int32_t left = take_count("num_options"); left > 0 && ok(); --left) {
    field("option_names", options.emplace_back().first);
  }
  for (auto& [name, value] : options) field("option_values", value);
}

void WireReader::require(bool condition, const char* name, const char* complaint) {
  if (!condition) fail(name, complaint);
}

base::Status WireReader::status() const {
  if (!ok()) return base::fail(error_);
  if (!bytes_.empty()) return base::fail(std::to_string(bytes_.size()) + " bytes are left over behind the message");
  return {};
}

std::uint64_t WireReader::take_bits(const char* name, std::size_t size) {
  if (!ok()) return 0;
  if (bytes_.size() < size) {
    fail(name, "is cut off");
    return 0;
  }
  std::uint64_t bits = 0;
  for (const std::uint8_t byte : bytes_.first(size)) bits = bits << 8U | byte;
  bytes_ = bytes_.subspan(size);
  return bits;
}

std::int32_t WireReader::take_count(const char* name) {
  std::int32_t count = 0;
  field(name, count);
  require(count >= 0, name, "has a negative length");
  return ok() ? count : 0;
}

void WireReader::fail(const char* name, const char* complaint) {
  if (ok()) error_ = "field '" + std::string(name) + "' " + complaint;
}

}  // namespace eg::procman
