#include "services/mapper/mapped_session.hpp"

namespace eg::services {
namespace {

constexpr double kMicroseconds = 1e6;
constexpr std::size_t kMegabyte = 1'000'000;

}  // namespace

MappedSession::MappedSession(const MapperOptions& options)
    : map(options.tsdf, static_cast<std::size_t>(options.image_budget) * kMegabyte),
      mesh_stream(static_cast<std::int64_t>(options.mesh_period * kMicroseconds)) {}

}  // namespace eg::services
