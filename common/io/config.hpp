#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/result.hpp"

namespace eg::io {

/// The values a number may take, both ends included.
struct Range {
  double low = std::numeric_limits<double>::lowest();
  double high = std::numeric_limits<double>::max();
};

/// Which keys a YAML mapping may have and which variables they set: a schema made of references into option structs.
///
///   ConfigSchema schema;
///   schema.field("min_points", options.min_points, {10, 4000}, "points a frame needs");
///   schema.section("lines", "segment detection").field("min_length", options.lines.min_length, {5, 640}, "pixels");
///   status = read_config("tracker.yaml", schema);
///
/// The schema refers to the variables: they must outlive it. Reading is strict: a key that is not in the schema, a key
/// given twice, a value of another type or out of range is an error "FILE:LINE: ...".
class ConfigSchema {
 public:
  ConfigSchema() = default;
  ConfigSchema(ConfigSchema&&) = default;  // not copied: a copy's fields would refer to the original's sections
  ConfigSchema& operator=(ConfigSchema&&) = default;

  using Names = std::vector<std::pair<std::string, int>>;  ///< name in the file, value

  ConfigSchema& field(std::string key, double& target, Range range, std::string help = {});
  ConfigSchema& field(std::string key, int& target, Range range, std::string help = {});
  ConfigSchema& field(std::string key, std::int64_t& target, Range range, std::string help = {});
  ConfigSchema& field(std::string key, bool& target, std::string help = {});
  ConfigSchema& field(std::string key, std::string& target, std::string help = {});
  /// A list of exactly as many numbers as `target` holds.
  ConfigSchema& list(std::string key, double* target, std::size_t count, Range range, std::string help = {});

  /// An enum, written by name.
  template <typename Enum>
  ConfigSchema& choice(std::string key, Enum& target, std::vector<std::pair<std::string, Enum>> names,
                       std::string help = {}) {
    Choice entry{{},
                 [&target](int value) { target = static_cast<Enum>(value); },
                 [&target] { return static_cast<int>(target); }};
    for (auto& [name, value] : names) entry.names.emplace_back(std::move(name), static_cast<int>(value));
    return add(std::move(key), std::move(entry), {}, std::move(help));
  }

  /// The last field added must be given; all others keep the value they have.
  ConfigSchema& required();

  /// A key that is somebody else's: it may be given, with any value, and is neither read nor printed.
  ConfigSchema& foreign(std::string key);

  /// A nested mapping. The reference stays valid as long as this schema.
  ConfigSchema& section(std::string key, std::string help = {});

  struct Choice {
    Names names;
    std::function<void(int)> set;
    std::function<int()> get;
  };
  struct List {
    double* values;
    std::size_t count;
  };
  struct Foreign {};
  using Target = std::variant<double*, int*, std::int64_t*, bool*, std::string*, List, Choice, ConfigSchema*, Foreign>;
  struct Field {
    std::string key;
    Target target;
    Range range;
    std::string help;
    bool required = false;
  };
  [[nodiscard]] const std::vector<Field>& fields() const { return fields_; }

 private:
  ConfigSchema& add(std::string key, Target target, Range range, std::string help);

  std::vector<Field> fields_;
  std::deque<ConfigSchema> sections_;  ///< a deque, because fields_ points into it
};

/// Sets the schema's variables from a YAML file. An empty file is fine. On an error some may have been set already.
base::Status read_config(const std::filesystem::path& path, const ConfigSchema& schema);

/// The same from text; `name` stands for the file in errors.
base::Status parse_config(std::string_view yaml, const std::string& name, const ConfigSchema& schema);

/// What is in force, as YAML that read_config() accepts, with each field's help as a comment.
std::string print_config(const ConfigSchema& schema);

}  // namespace eg::io
