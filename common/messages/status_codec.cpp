#include <egraph_msgs/service_status_t.hpp>

#include "common/messages/codec.hpp"
#include "common/messages/guard.hpp"
#include "common/messages/wire.hpp"
#include "common/messages/wire_geometry.hpp"

namespace eg::messages {
namespace {

void check_figures(const ServiceStatus& status, Checker& check) {
  const Path path;
  check.in_range(path("pid"), status.pid, 0, INT32_MAX);
  check.not_negative(path("latency_p50_ms"), status.latency_p50_ms);
  check.not_negative(path("latency_p90_ms"), status.latency_p90_ms);
  check.not_negative(path("latency_p99_ms"), status.latency_p99_ms);
  check.not_negative(path("latency_max_ms"), status.latency_max_ms);
  check.not_negative(path("cpu_seconds"), status.cpu_seconds);
}

base::Result<ServiceStatus> decode_status(ByteView bytes) {
  const auto wire = decode_wire<egraph_msgs::service_status_t>(
      bytes, {}, {{"service", kMaxName}, {"host", kMaxName}, {"state", kMaxName}, {"last_rejection", kMaxText}});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  ServiceStatus status;
  status.utime = read_counter(wire->utime, path("utime"), check);
  status.service = wire->service;
  status.host = wire->host;
  status.pid = wire->pid;
  status.state = wire->state;
  status.frames = read_counter(wire->frames, path("frames"), check);
  status.dropped = read_counter(wire->dropped, path("dropped"), check);
  status.rejected = read_counter(wire->rejected, path("rejected"), check);
  status.last_rejection = wire->last_rejection;
  status.latency_p50_ms = wire->latency_p50_ms;
  status.latency_p90_ms = wire->latency_p90_ms;
  status.latency_p99_ms = wire->latency_p99_ms;
  status.latency_max_ms = wire->latency_max_ms;
  status.cpu_seconds = wire->cpu_seconds;
  status.peak_memory_bytes = read_counter(wire->peak_memory_bytes, path("peak_memory_bytes"), check);
  check_figures(status, check);
  return checked(std::move(status), check);
}

}  // namespace

Bytes encode(const ServiceStatus& status) {
  egraph_msgs::service_status_t wire{};
  wire.utime = status.utime;
  wire.pid = status.pid;
  wire.frames = status.frames;
  wire.dropped = status.dropped;
  wire.rejected = status.rejected;
  wire.latency_p50_ms = status.latency_p50_ms;
  wire.latency_p90_ms = status.latency_p90_ms;
  wire.latency_p99_ms = status.latency_p99_ms;
  wire.latency_max_ms = status.latency_max_ms;
  wire.cpu_seconds = status.cpu_seconds;
  wire.peak_memory_bytes = status.peak_memory_bytes;
  wire.service = printable(status.service, kMaxName);
  wire.host = printable(status.host, kMaxName);
  wire.state = printable(status.state, kMaxName);
  wire.last_rejection = printable(status.last_rejection, kMaxText);
  return encode_wire(wire);
}

template <>
base::Result<ServiceStatus> decode(ByteView bytes) {
  return guarded<ServiceStatus>([&] { return decode_status(bytes); });
}

}  // namespace eg::messages
