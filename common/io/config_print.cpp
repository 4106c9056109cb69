#include "common/io/config.hpp"
#include "common/io/number_format.hpp"

namespace eg::io {
namespace {

std::string text_of(const double* value) { return format_number(*value); }
std::string text_of(const int* value) { return std::to_string(*value); }
std::string text_of(const std::int64_t* value) { return std::to_string(*value); }
std::string text_of(const bool* value) { return *value ? "true" : "false"; }

/// In double quotes, so that any text comes back as it is.
std::string text_of(const std::string* value) {
  std::string text = "\"";
  for (const char c : *value) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

std::string text_of(const ConfigSchema::List& list) {
  std::string text;
  for (std::size_t i = 0; i < list.count; ++i) text += (i == 0 ? "" : ", ") + format_number(list.values[i]);
  return "[" + text + "]";
}

std::string text_of(const ConfigSchema::Choice& choice) {
  const int current = choice.get();
  for (const auto& [name, value] : choice.names) {
    if (value == current) return name;
  }
  return {};
}

std::string text_of(ConfigSchema* /*section*/) { return {}; }
std::string text_of(const ConfigSchema::Foreign& /*target*/) { return {}; }

void print(const ConfigSchema& schema, const std::string& indent, std::string& out) {
  for (const auto& field : schema.fields()) {
    if (std::holds_alternative<ConfigSchema::Foreign>(field.target)) continue;
    const std::string value = std::visit([](const auto& target) { return text_of(target); }, field.target);
    out += indent + field.key + ":" + (value.empty() ? "" : " " + value);
    out += (field.help.empty() ? "" : "  # " + field.help) + "\n";
    if (const auto* section = std::get_if<ConfigSchema*>(&field.target)) print(**section, indent + "  ", out);
  }
}

}  // namespace

std::string print_config(const ConfigSchema& schema) {
  std::string out;
  print(schema, "", out);
  return out;
}

}  // namespace eg::io
