#include "common/base/check.hpp"
#include "common/io/config.hpp"

namespace eg::io {

ConfigSchema& ConfigSchema::field(std::string key, double& target, Range range, std::string help) {
  return add(std::move(key), &target, range, std::move(help));
}

ConfigSchema& ConfigSchema::field(std::string key, int& target, Range range, std::string help) {
  return add(std::move(key), &target, range, std::move(help));
}

ConfigSchema& ConfigSchema::field(std::string key, std::int64_t& target, Range range, std::string help) {
  return add(std::move(key), &target, range, std::move(help));
}

ConfigSchema& ConfigSchema::field(std::string key, bool& target, std::string help) {
  return add(std::move(key), &target, {}, std::move(help));
}

ConfigSchema& ConfigSchema::field(std::string key, std::string& target, std::string help) {
  return add(std::move(key), &target, {}, std::move(help));
}

ConfigSchema& ConfigSchema::list(std::string key, double* target, std::size_t count, Range range, std::string help) {
  return add(std::move(key), List{target, count}, range, std::move(help));
}

ConfigSchema& ConfigSchema::required() {
  EG_CHECK(!fields_.empty(), "required() follows a field");
  fields_.back().required = true;
  return *this;
}

ConfigSchema& ConfigSchema::foreign(std::string key) { return add(std::move(key), Foreign{}, {}, {}); }

ConfigSchema& ConfigSchema::section(std::string key, std::string help) {
  ConfigSchema& nested = sections_.emplace_back();
  add(std::move(key), &nested, {}, std::move(help));
  return nested;
}

ConfigSchema& ConfigSchema::add(std::string key, Target target, Range range, std::string help) {
  for (const Field& field : fields_) EG_CHECK(field.key != key, "two fields of a configuration have the same key");
  fields_.push_back({std::move(key), std::move(target), range, std::move(help)});
  return *this;
}

}  // namespace eg::io
