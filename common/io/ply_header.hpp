#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace eg::io {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
std::size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;    ///< of the value, or of a list's items
  std::optional<PlyType> count_type;  ///< set: a list with a count before it
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  bool ascii = false;
  std::vector<PlyElement> elements;
  std::size_t data_offset = 0;  ///< first byte after the header
};

/// The error is without the file's name.
base::Result<PlyHeader> parse_ply_header(std::string_view bytes);

}  // namespace eg::io
