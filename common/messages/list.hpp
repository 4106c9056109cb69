#pragma once

#include <cstdint>
#include <vector>

#include "common/messages/checker.hpp"

/// Lists of things that have a write() and a read(), which is the last argument: an overload set is resolved by the
/// lists.
namespace eg::messages {

/// Sets the LCM array and its count.
template <typename Value, typename WireItem>
void write_list(const std::vector<Value>& values, std::int32_t& count, std::vector<WireItem>& wire,
                WireItem (*write)(const Value&)) {
  count = static_cast<std::int32_t>(values.size());
  wire.reserve(values.size());
  for (const Value& value : values) wire.push_back(write(value));
}

template <typename Value, typename WireItem>
std::vector<Value> read_list(const std::vector<WireItem>& wire, const char* name, const Path& message, Checker& check,
                             Value (*read)(const WireItem&, const Path&, Checker&)) {
  std::vector<Value> values;
  values.reserve(wire.size());
  for (std::size_t i = 0; i < wire.size(); ++i) values.push_back(read(wire[i], message(name, i), check));
  return values;
}

}  // namespace eg::messages
