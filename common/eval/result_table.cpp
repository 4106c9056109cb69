#include "common/eval/result_table.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

namespace eg::eval {
namespace {

std::string fixed(double value, int decimals) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

/// The smallest value of a row, none if there is none.
Cell best_of(const ResultRow& row) {
  Cell best;
  for (const Cell& cell : row.values) {
    if (cell && !std::isnan(*cell) && (!best || *cell < *best)) best = cell;
  }
  return best;
}

std::string text_of(const Cell& cell, const Cell& best, int decimals) {
  if (!cell) return "- ";
  if (std::isnan(*cell)) return "x ";
  return fixed(*cell, decimals) + (cell == best ? "*" : " ");
}

/// CSV's own way with separators in texts.
std::string in_quotes(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

}  // namespace

std::string to_text(const ResultTable& table) {
  std::size_t name_width = 0;
  for (const ResultRow& row : table.rows) name_width = std::max(name_width, row.sequence.size());
  std::size_t width = 8;
  for (const std::string& column : table.columns) width = std::max(width, column.size());

  std::ostringstream text;
  text << table.title << '\n' << std::setw(static_cast<int>(name_width)) << "";
  for (const std::string& column : table.columns) {
    text << "  " << std::right << std::setw(static_cast<int>(width)) << column << ' ';
  }
  text << '\n';
  for (const ResultRow& row : table.rows) {
    text << std::left << std::setw(static_cast<int>(name_width)) << row.sequence << std::right;
    const Cell best = best_of(row);
    for (const Cell& cell : row.values) {
      text << "  " << std::setw(static_cast<int>(width) + 1) << text_of(cell, best, table.decimals);
    }
    text << '\n';
  }
  return text.str();
}

std::string to_csv(std::span<const ResultTable> tables) {
  std::ostringstream text;
  text << "table,sequence,system,value\n";
  for (const ResultTable& table : tables) {
    for (const ResultRow& row : table.rows) {
      for (std::size_t i = 0; i < row.values.size(); ++i) {
        const Cell& cell = row.values[i];
        if (!cell) continue;
        text << in_quotes(table.title) << ',' << in_quotes(row.sequence) << ',' << in_quotes(table.columns[i]) << ','
             << (std::isnan(*cell) ? "failed" : fixed(*cell, 6)) << '\n';
      }
    }
  }
  return text.str();
}

}  // namespace eg::eval
