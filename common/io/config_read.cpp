#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <limits>
#include <map>

#include "common/io/config.hpp"
#include "common/io/nearest_name.hpp"
#include "common/io/number_format.hpp"
#include "common/io/text_file.hpp"

namespace eg::io {
namespace {

/// A value in the file together with what is needed to say where it stands.
struct Value {
  const std::string& file;
  const ConfigSchema::Field& field;
  YAML::Node key;
  YAML::Node node;
};

tl::unexpected<base::Error> error_at(const std::string& file, const YAML::Node& node, const std::string& what) {
  return base::fail(located(file, node.Mark().line + 1, what));
}

tl::unexpected<base::Error> wrong_value(const Value& value, const std::string& wanted) {
  std::string found = value.node.IsMap() ? "a mapping" : value.node.IsSequence() ? "a list" : "nothing";
  if (value.node.IsScalar()) found = in_quotes(value.node.Scalar());
  // The parser places a missing value on the next line.
  const YAML::Node& place = value.node.IsNull() ? value.key : value.node;
  return error_at(value.file, place, "key '" + value.field.key + "' must be " + wanted + ", not " + found);
}

std::string range_text(const Range& range) {
  return "in [" + format_number(range.low) + ", " + format_number(range.high) + "]";
}

bool in_range(double number, const Range& range) { return number >= range.low && number <= range.high; }

/// The text of a plain value; that of a list or mapping is empty, which no type but text accepts.
std::string scalar_text(const YAML::Node& node) { return node.IsScalar() ? node.Scalar() : std::string(); }

base::Status read_number(const Value& value, double& target) {
  const auto number = parse_number(scalar_text(value.node));
  if (!number) return wrong_value(value, "a number");
  if (!in_range(*number, value.field.range)) return wrong_value(value, range_text(value.field.range));
  target = *number;
  return {};
}

template <typename T>
base::Status read_integer(const Value& value, T& target) {
  const auto number = parse_integer(scalar_text(value.node));
  if (!number) return wrong_value(value, "an integer");
  const bool fits = *number >= std::numeric_limits<T>::min() && *number <= std::numeric_limits<T>::max();
  if (!fits || !in_range(static_cast<double>(*number), value.field.range)) {
    return wrong_value(value, range_text(value.field.range));
  }
  target = static_cast<T>(*number);
  return {};
}

base::Status read_value(const Value& value, int* target) { return read_integer(value, *target); }
base::Status read_value(const Value& value, std::int64_t* target) { return read_integer(value, *target); }

base::Status read_value(const Value& value, double* target) { return read_number(value, *target); }

base::Status read_value(const Value& value, bool* target) {
  const std::string text = scalar_text(value.node);
  if (text != "true" && text != "false") return wrong_value(value, "true or false");
  *target = text == "true";
  return {};
}

base::Status read_value(const Value& value, std::string* target) {
  if (!value.node.IsScalar()) return wrong_value(value, "text");
  *target = value.node.Scalar();
  return {};
}

base::Status read_value(const Value& value, const ConfigSchema::List& target) {
  if (!value.node.IsSequence() || value.node.size() != target.count) {
    const std::string wanted = "a list of " + std::to_string(target.count) + " numbers";
    if (!value.node.IsSequence()) return wrong_value(value, wanted);
    return error_at(
        value.file, value.node,
        "key '" + value.field.key + "' must be " + wanted + ", but has " + std::to_string(value.node.size()));
  }
  for (std::size_t i = 0; i < target.count; ++i) {
    const Value element{value.file, value.field, value.key, value.node[i]};
    if (const auto status = read_number(element, target.values[i]); !status) return status;
  }
  return {};
}

base::Status read_value(const Value& value, const ConfigSchema::Choice& target) {
  const std::string text = scalar_text(value.node);
  std::vector<std::string> names;
  for (const auto& [name, number] : target.names) {
    names.push_back(name);
    if (name != text) continue;
    target.set(number);
    return {};
  }
  return wrong_value(value, "one of " + joined(names));
}

base::Status read_mapping(const std::string& file, const YAML::Node& node, const ConfigSchema& schema);

base::Status read_value(const Value& value, ConfigSchema* section) {
  if (value.node.IsNull()) return {};
  if (!value.node.IsMap()) return wrong_value(value, "a mapping");
  return read_mapping(value.file, value.node, *section);
}

base::Status read_value(const Value& /*value*/, const ConfigSchema::Foreign& /*target*/) { return {}; }

tl::unexpected<base::Error> unknown_key(const std::string& file, const YAML::Node& key, const ConfigSchema& schema) {
  std::vector<std::string> known;
  for (const auto& field : schema.fields()) known.push_back(field.key);
  const std::string nearest = nearest_name(key.Scalar(), known);
  return error_at(file, key,
                  "unknown key " + in_quotes(key.Scalar()) +
                      (nearest.empty() ? "; known keys: " + joined(known) : "; did you mean '" + nearest + "'?"));
}

base::Status read_mapping(const std::string& file, const YAML::Node& node, const ConfigSchema& schema) {
  std::map<std::string, int> line_of_key;
  for (const auto& entry : node) {
    const YAML::Node& key = entry.first;
    if (!key.IsScalar()) return error_at(file, key, "a key must be a plain word");
    const auto [seen, is_new] = line_of_key.emplace(key.Scalar(), key.Mark().line + 1);
    if (!is_new) {
      return error_at(file, key,
                      "key " + in_quotes(key.Scalar()) + " is already given on line " + std::to_string(seen->second));
    }
    const auto field = std::find_if(schema.fields().begin(), schema.fields().end(),
                                    [&](const auto& candidate) { return candidate.key == key.Scalar(); });
    if (field == schema.fields().end()) return unknown_key(file, key, schema);
    const auto read = [&](const auto& target) { return read_value(Value{file, *field, key, entry.second}, target); };
    if (const auto status = std::visit(read, field->target); !status) return status;
  }
  for (const auto& field : schema.fields()) {
    if (field.required && !line_of_key.contains(field.key)) {
      return error_at(file, node, "key '" + field.key + "' is missing" + (field.help.empty() ? "" : ": " + field.help));
    }
  }
  return {};
}

}  // namespace

base::Status parse_config(std::string_view yaml, const std::string& name, const ConfigSchema& schema) {
  try {
    const YAML::Node root = YAML::Load(std::string(yaml));
    if (root.IsMap()) return read_mapping(name, root, schema);
    if (root.IsNull()) return read_mapping(name, YAML::Load("{}"), schema);
    return error_at(name, root, "expected 'key: value' lines");
  } catch (const YAML::Exception& exception) {
    return base::fail(located(name, std::max(exception.mark.line, 0) + 1, "no valid YAML: " + exception.msg));
  }
}

base::Status read_config(const std::filesystem::path& path, const ConfigSchema& schema) {
  const auto yaml = read_file(path);
  if (!yaml) return tl::make_unexpected(yaml.error());
  return parse_config(*yaml, path.string(), schema);
}

}  // namespace eg::io
