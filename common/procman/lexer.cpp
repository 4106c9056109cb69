#include "common/procman/lexer.hpp"

namespace eg::procman {
namespace {

// Not <cctype>: the grammar is ASCII whatever the locale.
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool starts_identifier(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool continues_identifier(char c) { return starts_identifier(c) || is_digit(c) || c == '-'; }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

char unescape(char c) {
  switch (c) {
    case 'n':
      return '\n';
    case 'r':
      return '\r';
    case 't':
      return '\t';
    default:
      return c;
  }
}

}  // namespace

std::string describe(const Token& token) {
  switch (token.kind) {
    case Token::Kind::string:
      return '"' + token.text + '"';
    case Token::Kind::end:
      return "the end of the file";
    default:
      return "'" + token.text + "'";
  }
}

char Lexer::take() {
  const char c = text_[position_++];
  if (c == '\n') {
    place_ = {place_.line + 1, 1};
  } else {
    ++place_.column;
  }
  return c;
}

void Lexer::skip_space_and_comments() {
  while (!at_end()) {
    if (is_space(peek())) {
      take();
    } else if (peek() == '#') {
      while (!at_end() && peek() != '\n') take();
    } else {
      return;
    }
  }
}

base::Result<Token> Lexer::next() {
  skip_space_and_comments();
  Token token;
  token.place = place_;
  if (at_end()) return token;
  if (starts_identifier(peek())) return take_identifier(token);
  if (is_digit(peek())) return take_integer(token);
  const char c = take();
  token.text = std::string(1, c);
  switch (c) {
    case '"':
      return take_string(token);
    case '{':
      token.kind = Token::Kind::open_brace;
      return token;
    case '}':
      token.kind = Token::Kind::close_brace;
      return token;
    case '=':
      token.kind = Token::Kind::assign;
      return token;
    case ';':
      token.kind = Token::Kind::semicolon;
      return token;
    default:
      return fail_at(file_name_, token.place, "unexpected character '" + token.text + "'");
  }
}

base::Result<Token> Lexer::take_string(Token token) {
  token.kind = Token::Kind::string;
  token.text.clear();
  while (!at_end() && peek() != '\n') {
    const char c = take();
    if (c == '"') return token;
    if (c != '\\') {
      token.text += c;
    } else if (!at_end() && peek() != '\n') {
      token.text += unescape(take());
    }
  }
  return fail_at(file_name_, token.place, "the string that begins here does not end on its line");
}

base::Result<Token> Lexer::take_integer(Token token) {
  token.kind = Token::Kind::integer;
  while (is_digit(peek())) token.text += take();
  if (peek() == '.' || continues_identifier(peek())) {
    return fail_at(file_name_, token.place, "expected a decimal integer");
  }
  return token;
}

Token Lexer::take_identifier(Token token) {
  token.kind = Token::Kind::identifier;
  while (continues_identifier(peek())) token.text += take();
  return token;
}

}  // namespace eg::procman
