#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// What comes from files and networks must not command the terminal that shows it.
namespace eg::base {

/// The bytes of the control character that stands at text[at]: one of ASCII, or two of those that ISO 8859-1 has more
/// of and that terminals obey in UTF-8, too (U+0080 to U+009F). 0: what stands there is none.
std::size_t control_bytes_at(std::string_view text, std::size_t at);

/// The text with a blank for every control character but tabulators.
std::string printable(std::string_view text);

}  // namespace eg::base
