#include "services/mapper/mapped_session.hpp"

namespace eg::services {
namespace {

constexpr double kMicroseconds = 1e6;
constexpr std::size_t kMegabyte = 1'000'000;

}  // namespace

MappedSession::MappedSession(const MapperOptions& options)
    : map(options.tsdf, static_cast<std::size_t>(options.image_budget) * kMegabyte),
      mesh_stream(static_cast<std::int64_t>(options.mesh_period * kMicroseconds)) {}

FrameParts& MappedSession::parts_of(std::int64_t sequence) {
  const auto [frame, is_new] = frames.try_emplace(sequence);
  if (is_new) frame->second.arrival = arrivals++;
  return frame->second;
}

}  // namespace eg::services
