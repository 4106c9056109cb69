#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace eg::procman_sheriff {

/// "[name] line": who says it. Our own programs begin their lines so already, and are not named twice.
std::string with_name(const std::string& name, const std::string& line);

/// Lines on stderr, and below them, if that is a terminal, a table that is redrawn in its place.
class Console {
 public:
  Console();
  /// Leaves the table as it is.
  ~Console() = default;

  [[nodiscard]] bool shows_tables() const { return terminal_; }
  void print(const std::string& line);
  void show(std::vector<std::string> table);

 private:
  void erase_table() const;
  void draw_table() const;

  bool terminal_;
  std::vector<std::string> table_;
};

}  // namespace eg::procman_sheriff
