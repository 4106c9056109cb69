#include "common/procman/exec_line.hpp"

#include <cstdlib>

namespace eg::procman {
namespace {

bool starts_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool continues_name(char c) { return starts_name(c) || (c >= '0' && c <= '9'); }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string_view leading_name(std::string_view text) {
  if (text.empty() || !starts_name(text.front())) return {};
  std::size_t length = 1;
  while (length < text.size() && continues_name(text[length])) ++length;
  return text.substr(0, length);
}

/// Appends the quoted part that begins at text[position] to `word`. Returns the position after it; npos: it has no end.
std::size_t unquote(std::string_view text, std::size_t position, std::string& word) {
  const char quote = text[position++];
  while (position < text.size() && text[position] != quote) {
    constexpr std::string_view kEscapable = "\"\\$`";
    const bool escape = quote == '"' && text[position] == '\\' && position + 1 < text.size() &&
                        kEscapable.find(text[position + 1]) != std::string_view::npos;
    if (escape) ++position;
    word += text[position++];
  }
  return position < text.size() ? position + 1 : std::string_view::npos;
}

base::Result<std::vector<std::string>> split_words(std::string_view text) {
  std::vector<std::string> words;
  std::string word;
  bool in_word = false;  // '' is a word too
  for (std::size_t position = 0; position < text.size();) {
    const char c = text[position];
    if (is_blank(c)) {
      if (in_word) words.push_back(std::exchange(word, {}));
      in_word = false;
      ++position;
      continue;
    }
    in_word = true;
    if (c == '\'' || c == '"') {
      position = unquote(text, position, word);
      if (position == std::string_view::npos) return base::fail("a quote is not closed in: " + std::string(text));
    } else if (c == '\\') {
      if (position + 1 == text.size()) return base::fail("nothing follows the last backslash in: " + std::string(text));
      word += text[position + 1];
      position += 2;
    } else {
      word += c;
      ++position;
    }
  }
  if (in_word) words.push_back(word);
  return words;
}

std::string expand(std::string_view word, const LookUpVariable& look_up) {
  std::string result;
  while (!word.empty()) {
    const std::size_t dollar = word.find('$');
    result += word.substr(0, dollar);
    if (dollar == std::string_view::npos) break;
    word.remove_prefix(dollar);
    const bool braces = word.size() > 1 && word[1] == '{';
    const std::string_view name = leading_name(word.substr(braces ? 2 : 1));
    std::size_t length = 1 + name.size();
    const bool closed = !braces || (word.size() > length + 1 && word[length + 1] == '}');
    if (braces) length += 2;
    const auto value = !name.empty() && closed ? look_up(std::string(name)) : std::nullopt;
    if (!value) length = 1;  // keeps the dollar sign, and what follows is looked at as ordinary text
    result += value ? *value : std::string("$");
    word.remove_prefix(length);
  }
  return result;
}

}  // namespace

std::optional<std::string> look_up_in_environment(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  return value != nullptr ? std::optional<std::string>(value) : std::nullopt;
}

base::Result<ExecLine> parse_exec(std::string_view exec, const LookUpVariable& look_up) {
  const auto words = split_words(exec);
  if (!words) return tl::make_unexpected(words.error());
  ExecLine line;
  for (const std::string& word : *words) {
    const std::string_view name = leading_name(word);
    const bool assigns = line.words.empty() && !name.empty() && word.size() > name.size() && word[name.size()] == '=';
    if (assigns) {
      line.environment.emplace_back(name, expand(std::string_view(word).substr(name.size() + 1), look_up));
    } else {
      line.words.push_back(expand(word, look_up));
    }
  }
  if (line.words.empty()) return base::fail("no program in: " + std::string(exec));
  return line;
}

}  // namespace eg::procman
