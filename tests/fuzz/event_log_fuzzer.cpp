// The log reader against arbitrary bytes: it must come to the end, account for every byte, and read again what it read.
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>

#include "common/recording/stream_statistics.hpp"
#include "common/transport/event_log.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kHeaderBytes = 28;
  const std::string file(reinterpret_cast<const char*>(data), size);
  eg::transport::EventLogReader reader(std::make_unique<std::istringstream>(file), "fuzz.lcm", size);
  eg::recording::StreamStatistics statistics;
  std::uint64_t accounted = 0;
  for (;;) {
    const auto event = reader.next();
    if (!event) {
      accounted += reader.recover();
      continue;
    }
    if (!*event) break;
    if ((*event)->offset != accounted) std::abort();
    accounted += kHeaderBytes + (*event)->channel.size() + (*event)->bytes.size();
    statistics.add((*event)->channel, (*event)->bytes, (*event)->utime);
    reader.seek((*event)->offset);
    const auto again = reader.next();
    if (!again || !*again || (*again)->bytes != (*event)->bytes) std::abort();
  }
  if (accounted != size) std::abort();
  for (const auto& [name, channel] : statistics.channels()) {
    if (!(channel.seconds() >= 0.0 && channel.rate() >= 0.0) || channel.missing() < 0) std::abort();
  }
  return 0;
}
