#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Pieces of HTML that stand alone: no scripts, nothing loaded from elsewhere.
namespace eg::report {

/// The text with what HTML takes for markup replaced.
std::string escape(std::string_view text);

/// A PNG image inside the page.
std::string embedded_png(std::span<const std::uint8_t> png, std::string_view description);

/// A table; the first column is text, the others numbers. Cells are HTML.
std::string table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);

/// A section with a heading.
std::string section(std::string_view heading, std::string_view content);

/// A whole page, for wide screens and phones, light or dark as the reader's machine is.
std::string page(std::string_view title, std::string_view content);

}  // namespace eg::report
