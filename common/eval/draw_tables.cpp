#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/eval/draw.hpp"
#include "common/eval/result_table.hpp"

namespace eg::eval {
namespace {

const cv::Scalar kPaper(255, 255, 255);
const cv::Scalar kInk(60, 60, 60);
const cv::Scalar kGrid(225, 225, 225);
// Ours stands out, the others are told apart.
const std::array<cv::Scalar, 10> kColours = {{{200, 90, 20},
                                              {60, 60, 60},
                                              {60, 170, 90},
                                              {60, 60, 210},
                                              {190, 100, 180},
                                              {40, 150, 230},
                                              {160, 160, 60},
                                              {150, 150, 150},
                                              {110, 160, 200},
                                              {200, 200, 120}}};
constexpr int kBarWidth = 12, kGroupGap = 34, kLeft = 70, kRight = 30, kTop = 64, kPlotHeight = 260, kBottom = 44;
constexpr int kLeastGroup = 140;  // pixels: room for a sequence's name

/// Powers of ten around all values, as exponents.
struct Decades {
  int low = -3;
  int high = 0;

  [[nodiscard]] double height(double value) const {
    const double share = (std::log10(value) - low) / (high - low);
    return kPlotHeight * std::clamp(share, 0.0, 1.0);
  }
};

Decades decades_of(const ResultTable& table) {
  std::vector<double> logarithms;
  for (const ResultRow& row : table.rows) {
    for (const Cell& cell : row.values) {
      if (cell && *cell > 0.0) logarithms.push_back(std::log10(*cell));
    }
  }
  if (logarithms.empty()) return {};
  const auto [low, high] = std::minmax_element(logarithms.begin(), logarithms.end());
  const int bottom = static_cast<int>(std::floor(*low));
  return {bottom, std::max(bottom + 1, static_cast<int>(std::ceil(*high)))};
}

int group_width(const ResultTable& table) {
  return std::max(static_cast<int>(table.columns.size()) * kBarWidth + kGroupGap, kLeastGroup);
}

void draw_axis(cv::Mat& panel, const Decades& decades) {
  const int base = kTop + kPlotHeight;
  for (int exponent = decades.low; exponent <= decades.high; ++exponent) {
    const double y = base - decades.height(std::pow(10.0, exponent));
    draw_line(panel, {kLeft, y}, {static_cast<double>(panel.cols - kRight), y}, kGrid, 1);
    std::string label = "1";
    if (exponent < 0) label = "0." + std::string(static_cast<std::size_t>(-exponent - 1), '0') + "1";
    if (exponent > 0) label.append(static_cast<std::size_t>(exponent), '0');
    draw_text(panel, label, {12, static_cast<int>(y) + 5}, kInk);
  }
}

void draw_group(cv::Mat& panel, const ResultRow& row, int left, const Decades& decades) {
  const int base = kTop + kPlotHeight;
  for (std::size_t i = 0; i < row.values.size(); ++i) {
    const cv::Scalar& colour = kColours[i % kColours.size()];
    const int x = left + static_cast<int>(i) * kBarWidth;
    const Cell& cell = row.values[i];
    if (!cell) continue;
    if (std::isnan(*cell)) {
      draw_text(panel, "x", {x, base - 4}, colour);
      continue;
    }
    const int height = std::max(1, static_cast<int>(std::lround(decades.height(std::max(*cell, 1e-12)))));
    cv::rectangle(panel, {x, base - height, kBarWidth - 2, height}, colour, cv::FILLED);
  }
  draw_text(panel, row.sequence, {left, base + 24}, kInk);
}

void draw_systems(cv::Mat& panel, const ResultTable& table) {
  int x = kLeft;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    cv::rectangle(panel, {x, 36, 10, 10}, kColours[i % kColours.size()], cv::FILLED);
    draw_text(panel, table.columns[i], {x + 15, 46}, kInk);
    x += 36 + 10 * static_cast<int>(table.columns[i].size());
  }
}

}  // namespace

cv::Mat draw_tables(std::span<const ResultTable> tables) {
  int width = 900;
  for (const ResultTable& table : tables) {
    width = std::max(width, kLeft + kRight + group_width(table) * static_cast<int>(table.rows.size()));
  }
  constexpr int kPanelHeight = kTop + kPlotHeight + kBottom;
  cv::Mat image(std::max(1, kPanelHeight * static_cast<int>(tables.size())), width, CV_8UC3, kPaper);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    cv::Mat panel = image.rowRange(kPanelHeight * static_cast<int>(i), kPanelHeight * static_cast<int>(i + 1));
    const Decades decades = decades_of(tables[i]);
    draw_text(panel, tables[i].title, {kLeft, 22}, kInk);
    draw_systems(panel, tables[i]);
    draw_axis(panel, decades);
    for (std::size_t row = 0; row < tables[i].rows.size(); ++row) {
      draw_group(panel, tables[i].rows[row], kLeft + 10 + group_width(tables[i]) * static_cast<int>(row), decades);
    }
  }
  return image;
}

}  // namespace eg::eval
