#include "services/procman_sheriff/console.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace eg::procman_sheriff {
namespace {

/// Columns of the terminal: a line that wraps would spoil the count of lines to go up.
std::size_t terminal_width() {
  winsize size{};
  constexpr std::size_t kUsual = 80;
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsual;
}

}  // namespace

std::string with_name(const std::string& name, const std::string& line) {
  const std::string prefix = "[" + name + "] ";
  return line.starts_with(prefix) ? line : prefix + line;
}

Console::Console() : terminal_(isatty(STDERR_FILENO) == 1) {}

void Console::print(const std::string& line) {
  erase_table();
  std::fprintf(stderr, "%s\n", line.c_str());
  draw_table();
}

void Console::show(std::vector<std::string> table) {
  if (!terminal_) return;
  erase_table();
  table_ = std::move(table);
  draw_table();
}

void Console::erase_table() const {
  // Up to the first line of the table, and away with everything below.
  if (!table_.empty()) std::fprintf(stderr, "\x1b[%zuA\x1b[J", table_.size());
}

void Console::draw_table() const {
  const std::size_t width = terminal_ ? terminal_width() : 0;
  for (const std::string& line : table_) std::fprintf(stderr, "%s\n", line.substr(0, width).c_str());
}

}  // namespace eg::procman_sheriff
