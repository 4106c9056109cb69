#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Tables of errors, one row per sequence and one column per system, for people, for programs and as a picture.
namespace eg::eval {

/// None: not measured or not published. NaN: the system fails on the sequence.
using Cell = std::optional<double>;

struct ResultRow {
  std::string sequence;
  std::vector<Cell> values;  ///< one per column
};

struct ResultTable {
  std::string title;                 ///< with the unit
  int decimals = 3;                  ///< to be printed
  std::vector<std::string> columns;  ///< names of systems; the first is ours
  std::vector<ResultRow> rows;
};

/// Aligned columns; "-" for none, "x" for a failure, "*" behind the smallest value of a row.
std::string to_text(const ResultTable& table);

/// One line per value: table,sequence,system,value. Failures are "failed", what is missing is left out.
std::string to_csv(std::span<const ResultTable> tables);

/// Bars on a logarithmic scale, one group per row, one colour per column, one panel per table. CV_8UC3, BGR.
cv::Mat draw_tables(std::span<const ResultTable> tables);

}  // namespace eg::eval
