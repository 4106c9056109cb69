#pragma once

#include <span>
#include <string>
#include <string_view>

namespace eg::io {

/// The number of letters to insert, delete or replace to turn one word into the other (Levenshtein 1966).
int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `name`, the first of equals; empty if none is similar enough to be a slip of the keyboard.
std::string nearest_name(std::string_view name, std::span<const std::string> candidates);

/// "a, b, c".
std::string joined(std::span<const std::string> names);

}  // namespace eg::io
