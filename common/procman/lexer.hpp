#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "common/procman/configuration.hpp"

namespace eg::procman {

struct Token {
  enum class Kind { identifier, string, integer, open_brace, close_brace, assign, semicolon, end };
  Kind kind = Kind::end;
  std::string text;  ///< identifier, digits, or the string with its escapes resolved
  Place place;       ///< of its first character
};

/// How a token is called in an error message, e.g. `"tracker"` or `the end of the file`.
std::string describe(const Token& token);

/// Splits a configuration file into tokens; `#` comments and white space separate them.
class Lexer {
 public:
  Lexer(std::string_view text, std::string file_name) : text_(text), file_name_(std::move(file_name)) {}

  base::Result<Token> next();

 private:
  [[nodiscard]] bool at_end() const { return position_ == text_.size(); }
  [[nodiscard]] char peek() const { return at_end() ? '\0' : text_[position_]; }
  char take();
  void skip_space_and_comments();
  base::Result<Token> take_string(Token token);
  base::Result<Token> take_integer(Token token);
  Token take_identifier(Token token);

  std::string_view text_;
  std::string file_name_;
  std::size_t position_ = 0;
  Place place_{1, 1};
};

}  // namespace eg::procman
