#include "common/report/html.hpp"

#include <spdlog/fmt/fmt.h>

namespace eg::report {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --text: #1d2530; --soft: #66758a; --line: #d9dfe7; --back: #ffffff; --card: #f4f6f9;
  --estimate: #2f6fde; --truth: #e0a100; --good: #18a06a; --warn: #e08a00; --bad: #d93a3a; }
@media (prefers-color-scheme: dark) { :root { --text: #e6ebf1; --soft: #93a1b3; --line: #2c3746; --back: #11161d;
  --card: #19212c; --estimate: #6ea8fe; --truth: #ffd84d; --good: #3ddc97; --warn: #ffb454; --bad: #ff5d5d; } }
body { margin: 0 auto; padding: 16px; max-width: 1100px; background: var(--back); color: var(--text);
  font: 15px/1.5 system-ui, sans-serif; }
h1 { font-size: 22px; margin: 8px 0; } h2 { font-size: 17px; margin: 28px 0 8px; } p { margin: 6px 0; }
.soft, figcaption { color: var(--soft); } figcaption { font-size: 13px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(128px, 1fr)); gap: 8px; margin: 12px 0; }
.tiles div { background: var(--card); border-radius: 8px; padding: 8px 12px; }
.tiles b { display: block; font-size: 19px; font-variant-numeric: tabular-nums; } .tiles span { color: var(--soft); font-size: 13px; }
.row { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(300px, 100%), 1fr)); gap: 12px; }
.wide { grid-template-columns: repeat(auto-fit, minmax(min(400px, 100%), 1fr)); }
figure { margin: 0; background: var(--card); border-radius: 8px; padding: 8px; min-width: 0; }
svg, img { display: block; width: 100%; height: auto; border-radius: 4px; }
svg text { font: 12px system-ui, sans-serif; fill: var(--soft); }
@media (max-width: 600px) { .plot text { font-size: 20px; } }
.scroll { overflow-x: auto; } table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: 4px 8px; border-bottom: 1px solid var(--line); white-space: nowrap; }
th { color: var(--soft); font-weight: 400; } th:first-child, td:first-child { text-align: left; }
pre { background: var(--card); border-radius: 8px; padding: 12px; overflow-x: auto; font-size: 13px; }
.estimate { color: var(--estimate); } .truth { color: var(--truth); } .bad { color: var(--bad); }
)";

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = (bits << 8U) | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[(bits >> (18U - 6U * k)) & 63U] : '=';
  }
  return text;
}

}  // namespace

std::string escape(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string embedded_png(std::span<const std::uint8_t> png, std::string_view description) {
  return fmt::format(R"(<img alt="{}" src="data:image/png;base64,{}">)", escape(description), base64(png));
}

std::string table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<div class=\"scroll\"><table><tr>";
  for (const std::string& cell : header) html.append("<th>").append(cell).append("</th>");
  html += "</tr>\n";
  for (const auto& row : rows) {
    html += "<tr>";
    for (const std::string& cell : row) html.append("<td>").append(cell).append("</td>");
    html += "</tr>\n";
  }
  return html.append("</table></div>\n");
}

std::string section(std::string_view heading, std::string_view content) {
  return fmt::format("<section><h2>{}</h2>\n{}</section>\n", escape(heading), content);
}

std::string page(std::string_view title, std::string_view content) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<title>{}</title><style>{}</style></head>\n<body>\n{}</body></html>\n",
      escape(title), kStyle, content);
}

}  // namespace eg::report
