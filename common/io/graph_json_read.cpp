#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "common/io/graph_json.hpp"
#include "common/io/graph_json_names.hpp"
#include "common/io/text_file.hpp"
#include "common/io/time_stamp.hpp"

namespace eg::io {
namespace {

using Json = nlohmann::json;

constexpr double kUnitTolerance = 1e-6;

/// Carries the sentence about a bad field from anywhere in the tree up to parse_graph(), and no further.
struct BadField {
  std::string message;
};

/// A JSON value and its place, e.g. "landmarks[3].direction".
class Field {
 public:
  Field(const Json& json, std::string place) : json_(&json), place_(std::move(place)) {}

  [[noreturn]] void refuse(const std::string& why) const { throw BadField{place_ + ": " + why}; }

  [[nodiscard]] Field at(const char* key) const {
    if (!json_->is_object() || !json_->contains(key)) throw BadField{dotted(key) + ": is missing"};
    return {(*json_)[key], dotted(key)};
  }
  [[nodiscard]] std::vector<Field> items() const {
    if (!json_->is_array()) refuse("must be a list");
    std::vector<Field> fields;
    for (std::size_t i = 0; i < json_->size(); ++i)
      fields.emplace_back((*json_)[i], place_ + "[" + std::to_string(i) + "]");
    return fields;
  }
  [[nodiscard]] double number() const {
    if (!json_->is_number()) refuse("must be a number");
    return json_->get<double>();
  }
  template <typename T>
  [[nodiscard]] T integer() const {
    if (!json_->is_number_integer()) refuse("must be an integer");
    const auto value = json_->get<std::int64_t>();
    if (value < 0 || value > std::numeric_limits<T>::max()) refuse("is out of range");
    return static_cast<T>(value);
  }
  [[nodiscard]] std::string text() const {
    if (!json_->is_string()) refuse("must be text");
    return json_->get<std::string>();
  }
  [[nodiscard]] std::vector<double> numbers(std::size_t count) const {
    if (!json_->is_array() || json_->size() != count) refuse("must be " + std::to_string(count) + " numbers");
    std::vector<double> values;
    for (const Field& item : items()) values.push_back(item.number());
    return values;
  }

 private:
  [[nodiscard]] std::string dotted(const char* key) const { return place_.empty() ? key : place_ + "." + key; }

  const Json* json_;
  std::string place_;
};

Eigen::Vector3d vector_in(const Field& field) {
  const auto values = field.numbers(3);
  return {values[0], values[1], values[2]};
}

Eigen::Vector3d direction_in(const Field& field) {
  const Eigen::Vector3d direction = vector_in(field);
  if (!(std::abs(direction.norm() - 1.0) < kUnitTolerance)) field.refuse("must be a unit vector");
  return direction;
}

Eigen::Matrix3d orientation_in(const Field& field) {
  const auto values = field.numbers(4);
  const Eigen::Quaterniond q(values[0], values[1], values[2], values[3]);
  if (!(std::abs(q.norm() - 1.0) < kUnitTolerance)) field.refuse("must be a unit quaternion");
  return q.normalized().toRotationMatrix();
}

template <int N>
Eigen::Matrix<double, N, N> symmetric_in(const Field& field) {
  const auto values = field.numbers(N * (N + 1) / 2);
  Eigen::Matrix<double, N, N> matrix;
  auto value = values.begin();
  for (int row = 0; row < N; ++row) {
    for (int column = row; column < N; ++column) matrix(row, column) = matrix(column, row) = *value++;
  }
  return matrix;
}

template <typename Id>
Id id_in(const Field& field) {
  return {field.integer<std::int32_t>()};
}

/// An id that must be among those already read.
template <typename Id>
Id known_id(const Field& field, const std::set<Id>& known) {
  const Id id = id_in<Id>(field);
  if (!known.contains(id)) field.refuse("refers to a node that does not exist");
  return id;
}

template <typename Id>
Id new_id(const Field& field, std::set<Id>& known) {
  const Id id = id_in<Id>(field);
  if (!known.insert(id).second) field.refuse("repeats an id");
  return id;
}

class GraphReader {
 public:
  egraph::GraphWithEdges read(const Field& root) {
    if (root.at("version").integer<int>() != kGraphJsonVersion) root.at("version").refuse("must be 1");
    for (const Field& item : root.at("keyframes").items()) graph_.keyframes.push_back(keyframe(item));
    for (const Field& item : root.at("landmarks").items()) graph_.landmarks.push_back(landmark(item));
    for (const Field& item : root.at("observations").items()) graph_.observations.push_back(observation(item));
    for (const Field& item : root.at("edges").items()) graph_.edges.push_back(edge(item));
    for (const Field& item : root.at("covisibility").items()) {
      graph_.covisibility.push_back({known_id(item.at("first"), keyframes_), known_id(item.at("second"), keyframes_),
                                     item.at("shared_features").integer<std::int32_t>()});
    }
    return std::move(graph_);
  }

 private:
  egraph::KeyframeNode keyframe(const Field& field) {
    egraph::KeyframeNode node;
    node.id = new_id(field.at("id"), keyframes_);
    node.sequence = field.at("sequence").integer<std::int64_t>();
    node.utime = to_utime(field.at("time_s").number());
    node.world_from_camera = {orientation_in(field.at("orientation")), vector_in(field.at("position"))};
    node.covariance = symmetric_in<6>(field.at("covariance"));
    return node;
  }

  egraph::DirectionLandmark landmark(const Field& field) {
    egraph::DirectionLandmark node;
    node.id = new_id(field.at("id"), landmarks_);
    const auto kind = kind_named(field.at("kind").text());
    if (!kind) field.at("kind").refuse("must be plane, vanishing_direction or potential_direction");
    node.kind = *kind;
    node.direction = direction_in(field.at("direction"));
    node.covariance = symmetric_in<3>(field.at("covariance"));
    node.observations = field.at("observations").integer<std::int32_t>();
    node.first_seen = known_id(field.at("first_seen"), keyframes_);
    node.last_seen = known_id(field.at("last_seen"), keyframes_);
    return node;
  }

  egraph::Observation observation(const Field& field) {
    return {known_id(field.at("keyframe"), keyframes_), known_id(field.at("landmark"), landmarks_),
            direction_in(field.at("direction")), symmetric_in<3>(field.at("covariance"))};
  }

  egraph::Edge edge(const Field& field) {
    egraph::Edge result{known_id(field.at("first"), keyframes_), known_id(field.at("second"), keyframes_), {}};
    for (const Field& id : field.at("landmarks").items()) result.shared.push_back(known_id(id, landmarks_));
    return result;
  }

  egraph::GraphWithEdges graph_;
  std::set<egraph::KeyframeId> keyframes_;
  std::set<egraph::LandmarkId> landmarks_;
};

}  // namespace

base::Result<egraph::GraphWithEdges> parse_graph(std::string_view json) {
  const Json root = Json::parse(json, nullptr, false);
  if (root.is_discarded()) return base::fail("is no valid JSON");
  try {
    return GraphReader().read(Field(root, ""));
  } catch (const BadField& bad) {
    return base::fail(bad.message);
  }
}

base::Result<egraph::GraphWithEdges> read_graph(const std::filesystem::path& path) {
  const auto json = read_file(path);
  if (!json) return tl::make_unexpected(json.error());
  auto graph = parse_graph(*json);
  if (!graph) return base::fail(path.string() + ": " + graph.error().message);
  return graph;
}

}  // namespace eg::io
