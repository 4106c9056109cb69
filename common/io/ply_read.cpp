#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/io/ply.hpp"
#include "common/io/ply_header.hpp"
#include "common/io/text_file.hpp"

namespace eg::io {
namespace {

/// Takes values from the data part, one after the other. After the end it gives NaN for ever.
class PlyValues {
 public:
  PlyValues(std::string_view data, bool ascii) : data_(data), ascii_(ascii) {}

  double next(PlyType type) { return ascii_ ? next_word() : next_binary(type); }
  [[nodiscard]] bool ran_out() const { return ran_out_; }
  /// No element can take less than this from the file: bounds what a header may promise.
  [[nodiscard]] std::size_t bytes_left() const { return data_.size(); }

 private:
  double fail() {
    ran_out_ = true;
    return std::numeric_limits<double>::quiet_NaN();
  }

  double next_word() {
    constexpr std::string_view kBlanks = " \t\r\n";
    data_.remove_prefix(std::min(data_.find_first_not_of(kBlanks), data_.size()));
    const std::string_view word = data_.substr(0, data_.find_first_of(kBlanks));
    data_.remove_prefix(word.size());
    const auto number = parse_number(word);
    return number ? *number : fail();
  }

  template <typename T>
  double take() {
    T value;
    std::memcpy(&value, data_.data(), sizeof(T));
    data_.remove_prefix(sizeof(T));
    return static_cast<double>(value);
  }

  double next_binary(PlyType type) {
    if (data_.size() < size_of(type)) return fail();
    switch (type) {
      case PlyType::int8:
        return take<std::int8_t>();
      case PlyType::uint8:
        return take<std::uint8_t>();
      case PlyType::int16:
        return take<std::int16_t>();
      case PlyType::uint16:
        return take<std::uint16_t>();
      case PlyType::int32:
        return take<std::int32_t>();
      case PlyType::uint32:
        return take<std::uint32_t>();
      case PlyType::float32:
        return take<float>();
      case PlyType::float64:
        return take<double>();
    }
    return fail();
  }

  std::string_view data_;
  bool ascii_;
  bool ran_out_ = false;
};

using Row = std::vector<std::vector<double>>;  ///< per property its values; one, or a list's

base::Result<Row> read_row(PlyValues& values, const PlyElement& element) {
  Row row;
  for (const PlyProperty& property : element.properties) {
    const double count = property.count_type ? values.next(*property.count_type) : 1.0;
    if (!(count >= 0.0) || count > static_cast<double>(values.bytes_left())) {
      return base::fail("holds less data than its header promises");
    }
    std::vector<double>& list = row.emplace_back(static_cast<std::size_t>(count));
    for (double& value : list) value = values.next(property.type);
  }
  if (values.ran_out()) return base::fail("holds less data than its header promises");
  return row;
}

/// Where in a row the named scalar properties are; empty if one of them is missing or a list.
template <std::size_t N>
std::optional<std::array<std::size_t, N>> columns(const PlyElement& element, std::array<std::string_view, N> names) {
  std::array<std::size_t, N> found{};
  for (std::size_t i = 0; i < N; ++i) {
    const auto it = std::find_if(element.properties.begin(), element.properties.end(),
                                 [&](const PlyProperty& p) { return p.name == names[i] && !p.count_type; });
    if (it == element.properties.end()) return std::nullopt;
    found[i] = static_cast<std::size_t>(it - element.properties.begin());
  }
  return found;
}

Eigen::Vector3f vector_at(const Row& row, const std::array<std::size_t, 3>& at) {
  return Eigen::Vector3d(row[at[0]][0], row[at[1]][0], row[at[2]][0]).cast<float>();
}

/// Colours may be any numbers in a file, also none: that is black.
std::uint8_t to_byte(double value) {
  return std::isnan(value) ? std::uint8_t{0} : static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
}

base::Status read_vertices(PlyValues& values, const PlyElement& element, PlyData& data) {
  const auto position = columns<3>(element, {"x", "y", "z"});
  const auto normal = columns<3>(element, {"nx", "ny", "nz"});
  const auto colour = columns<3>(element, {"red", "green", "blue"});
  if (!position) return base::fail("vertices have no coordinates x, y, z");
  if (!data.vertices.empty()) return base::fail("holds vertices in two places");
  for (std::size_t i = 0; i < element.count; ++i) {
    const auto row = read_row(values, element);
    if (!row) return tl::make_unexpected(row.error());
    data.vertices.push_back(vector_at(*row, *position));
    if (!data.vertices.back().allFinite()) return base::fail("vertex " + std::to_string(i) + " is not finite");
    if (normal) data.normals.push_back(vector_at(*row, *normal));
    if (!colour) continue;
    const auto& [r, g, b] = *colour;
    data.colours.push_back({to_byte((*row)[r][0]), to_byte((*row)[g][0]), to_byte((*row)[b][0])});
  }
  return {};
}

base::Result<std::uint32_t> vertex_index(double value, const PlyData& data) {
  if (value >= 0.0 && value < static_cast<double>(data.vertices.size())) return static_cast<std::uint32_t>(value);
  return base::fail("a face or edge refers to a vertex that does not exist");
}

base::Status read_faces(PlyValues& values, const PlyElement& element, PlyData& data) {
  const auto list = std::find_if(element.properties.begin(), element.properties.end(), [](const PlyProperty& p) {
    return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
  });
  if (list == element.properties.end()) return base::fail("faces have no list vertex_indices");
  const auto column = static_cast<std::size_t>(list - element.properties.begin());
  for (std::size_t i = 0; i < element.count; ++i) {
    const auto row = read_row(values, element);
    if (!row) return tl::make_unexpected(row.error());
    std::vector<std::uint32_t> corners;
    for (const double value : (*row)[column]) {
      const auto index = vertex_index(value, data);
      if (!index) return tl::make_unexpected(index.error());
      corners.push_back(*index);
    }
    for (std::size_t c = 2; c < corners.size(); ++c) data.triangles.push_back({corners[0], corners[c - 1], corners[c]});
  }
  return {};
}

base::Status read_edges(PlyValues& values, const PlyElement& element, PlyData& data) {
  const auto ends = columns<2>(element, {"vertex1", "vertex2"});
  if (!ends) return base::fail("edges have no ends vertex1, vertex2");
  for (std::size_t i = 0; i < element.count; ++i) {
    const auto row = read_row(values, element);
    if (!row) return tl::make_unexpected(row.error());
    const auto first = vertex_index((*row)[(*ends)[0]][0], data);
    const auto second = vertex_index((*row)[(*ends)[1]][0], data);
    if (!first) return tl::make_unexpected(first.error());
    if (!second) return tl::make_unexpected(second.error());
    data.edges.push_back({*first, *second});
  }
  return {};
}

base::Status skip(PlyValues& values, const PlyElement& element) {
  for (std::size_t i = 0; i < element.count; ++i) {
    if (const auto row = read_row(values, element); !row) return tl::make_unexpected(row.error());
  }
  return {};
}

base::Result<PlyData> parse_ply(std::string_view bytes) {
  const auto header = parse_ply_header(bytes);
  if (!header) return tl::make_unexpected(header.error());
  PlyValues values(bytes.substr(header->data_offset), header->ascii);
  PlyData data;
  for (const PlyElement& element : header->elements) {
    base::Status status;
    if (element.properties.empty()) continue;
    if (element.name == "vertex") {
      status = read_vertices(values, element, data);
    } else if (element.name == "face") {
      status = read_faces(values, element, data);
    } else if (element.name == "edge") {
      status = read_edges(values, element, data);
    } else {
      status = skip(values, element);
    }
    if (!status) return tl::make_unexpected(status.error());
  }
  const bool has_vertices = std::any_of(header->elements.begin(), header->elements.end(),
                                        [](const PlyElement& element) { return element.name == "vertex"; });
  if (!has_vertices) return base::fail("holds no vertex element");
  return data;
}

}  // namespace

base::Result<PlyData> read_ply(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) return tl::make_unexpected(bytes.error());
  auto data = parse_ply(*bytes);
  if (!data) return base::fail(path.string() + ": " + data.error().message);
  return data;
}

}  // namespace eg::io
