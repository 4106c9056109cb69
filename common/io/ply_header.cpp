#include "common/io/ply_header.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "common/io/text_file.hpp"

namespace eg::io {
namespace {

std::optional<PlyType> type_named(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes = {{{"char", PlyType::int8},
                                                                                   {"uchar", PlyType::uint8},
                                                                                   {"short", PlyType::int16},
                                                                                   {"ushort", PlyType::uint16},
                                                                                   {"int", PlyType::int32},
                                                                                   {"uint", PlyType::uint32},
                                                                                   {"float", PlyType::float32},
                                                                                   {"double", PlyType::float64},
                                                                                   {"int8", PlyType::int8},
                                                                                   {"uint8", PlyType::uint8},
                                                                                   {"int16", PlyType::int16},
                                                                                   {"uint16", PlyType::uint16},
                                                                                   {"int32", PlyType::int32},
                                                                                   {"uint32", PlyType::uint32},
                                                                                   {"float32", PlyType::float32},
                                                                                   {"float64", PlyType::float64}}};
  const auto it = std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& entry) { return entry.first == name; });
  return it == kTypes.end() ? std::nullopt : std::optional(it->second);
}

using Fields = std::vector<std::string_view>;

base::Result<PlyElement> parse_element(const Fields& fields) {
  const auto count = fields.size() == 3 ? parse_integer(fields[2]) : std::nullopt;
  if (!count || *count < 0) return base::fail("expected 'element NAME COUNT'");
  return PlyElement{std::string(fields[1]), static_cast<std::size_t>(*count), {}};
}

base::Result<PlyProperty> parse_property(const Fields& fields) {
  if (fields.size() == 3) {
    const auto type = type_named(fields[1]);
    if (!type) return base::fail("unknown type " + in_quotes(fields[1]));
    return PlyProperty{std::string(fields[2]), *type, std::nullopt};
  }
  if (fields.size() != 5 || fields[1] != "list") return base::fail("expected 'property TYPE NAME'");
  const auto count_type = type_named(fields[2]);
  const auto item_type = type_named(fields[3]);
  if (!count_type || !item_type) return base::fail("unknown type in a list");
  return PlyProperty{std::string(fields[4]), *item_type, count_type};
}

base::Status parse_line(const Fields& fields, PlyHeader& header) {
  if (fields[0] == "comment" || fields[0] == "obj_info") return {};
  if (fields[0] == "format" && fields.size() == 3) {
    if (fields[1] != "ascii" && fields[1] != "binary_little_endian") {
      return base::fail("format " + in_quotes(fields[1]) + " is not supported; ascii and binary_little_endian are");
    }
    header.ascii = fields[1] == "ascii";
    return {};
  }
  if (fields[0] == "element") {
    return parse_element(fields).map([&](const PlyElement& element) { header.elements.push_back(element); });
  }
  if (fields[0] == "property") {
    if (header.elements.empty()) return base::fail("property before the first element");
    return parse_property(fields).map(
        [&](const PlyProperty& property) { header.elements.back().properties.push_back(property); });
  }
  return base::fail("unknown header line " + in_quotes(fields[0]));
}

}  // namespace

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      return 8;
  }
  return 8;
}

base::Result<PlyHeader> parse_ply_header(std::string_view bytes) {
  PlyHeader header;
  for (int line = 1; header.data_offset < bytes.size(); ++line) {
    const std::size_t end = std::min(bytes.find('\n', header.data_offset), bytes.size());
    const Fields fields = split_fields(bytes.substr(header.data_offset, end - header.data_offset));
    header.data_offset = std::min(end + 1, bytes.size());
    if (line == 1) {
      if (fields.empty() || fields[0] != "ply") return base::fail("is no PLY file");
      continue;
    }
    if (fields.empty()) continue;
    if (fields[0] == "end_header") return header;
    if (const auto status = parse_line(fields, header); !status) {
      return base::fail("header line " + std::to_string(line) + ": " + status.error().message);
    }
  }
  return base::fail(bytes.empty() ? "is empty" : "PLY header has no end");
}

}  // namespace eg::io
