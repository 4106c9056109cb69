#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace eg::base {

/// An integer identity that cannot be mixed up with another kind of identity. Invalid until it is given a value.
template <typename Tag>
struct Id {
  std::int32_t value = -1;

  [[nodiscard]] bool valid() const { return value >= 0; }
  auto operator<=>(const Id&) const = default;
};

}  // namespace eg::base

template <typename Tag>
struct std::hash<eg::base::Id<Tag>> {
  std::size_t operator()(const eg::base::Id<Tag>& id) const noexcept { return std::hash<std::int32_t>{}(id.value); }
};
