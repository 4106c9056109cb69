#include "common/io/observation_source.hpp"

#include <string_view>
#include <utility>

#include "common/io/open_structure.hpp"
#include "common/io/text_file.hpp"
#include "common/observations/walk.hpp"

namespace eg::io {
namespace {

constexpr std::string_view kSynthetic = "synthetic:";

base::Result<ObservationSource> make_synthetic(std::string_view name, const std::optional<std::string>& camera,
                                               const observations::SensorModel& sensor) {
  if (name != "walk") {
    return base::fail(in_quotes(name) + " is no synthetic recording of observations: there is 'walk'");
  }
  const std::string camera_name = camera ? *camera : std::string("synthetic");
  const auto model = read_camera(camera_name);
  if (!model) return tl::make_unexpected(model.error());
  observations::WalkOptions options;
  options.seed = sensor.seed;
  return ObservationSource{make_walk(*model, sensor, options), {*model, std::string("camera ").append(camera_name)}};
}

}  // namespace

base::Result<ObservationSource> open_observations(const std::string& source, const std::optional<std::string>& camera,
                                                  const observations::SensorModel& sensor) {
  if (source.starts_with(kSynthetic)) return make_synthetic(source.substr(kSynthetic.size()), camera, sensor);
  auto resolved = resolve_camera(source, camera);
  if (!resolved) return tl::make_unexpected(resolved.error());
  auto recording = read_open_structure(source);
  if (!recording) return tl::make_unexpected(recording.error());
  return ObservationSource{*std::move(recording), *std::move(resolved)};
}

}  // namespace eg::io
