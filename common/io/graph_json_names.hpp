#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "common/egraph/types.hpp"

/// What reader and writer of egraph.json share.
namespace eg::io {

inline constexpr int kGraphJsonVersion = 1;

inline constexpr std::array<std::pair<egraph::DirectionKind, std::string_view>, 3> kDirectionKindNames = {{
    {egraph::DirectionKind::plane_normal, "plane"},
    {egraph::DirectionKind::vanishing_direction, "vanishing_direction"},
    {egraph::DirectionKind::potential_direction, "potential_direction"},
}};

inline std::string_view name_of(egraph::DirectionKind kind) {
  for (const auto& [value, name] : kDirectionKindNames) {
    if (value == kind) return name;
  }
  return {};
}

inline std::optional<egraph::DirectionKind> kind_named(std::string_view wanted) {
  for (const auto& [value, name] : kDirectionKindNames) {
    if (name == wanted) return value;
  }
  return std::nullopt;
}

}  // namespace eg::io
