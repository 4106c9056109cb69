#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

/// Small tools shared by the readers of line-based text files.
namespace eg::io {

/// The bytes of a whole file. The error names the path and says why (no such file, permission, a folder).
base::Result<std::string> read_file(const std::filesystem::path& path);

/// A line with content: comments (from '#' at its start), blank lines and line ends are gone.
struct TextLine {
  int number = 0;         ///< counted from 1
  std::string_view text;  ///< points into the text that was split
};
std::vector<TextLine> content_lines(std::string_view text);

/// The fields of a line, separated by blanks, tabs or commas.
std::vector<std::string_view> split_fields(std::string_view line);

/// The finite number that `text` as a whole is in decimal notation; anything else (nan, inf, 0x1, 1.5m) is none.
std::optional<double> parse_number(std::string_view text);
std::optional<long long> parse_integer(std::string_view text);

/// "FILE:LINE: what", the form of every error about a line.
std::string located(const std::filesystem::path& path, int line, std::string_view what);

/// At most 40 characters of untrusted text, printable, in quotes, for error messages.
std::string in_quotes(std::string_view text);

}  // namespace eg::io
