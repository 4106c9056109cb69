// The reader of packed tiles (map archives) against arbitrary bytes. What is accepted must pack again to a tile that is
// accepted, and mesh without harm.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/mapping/tsdf_map.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Eigen::Vector3i tile(1, -2, 3);
  eg::mapping::TsdfMap map;
  if (!map.unpack_tile(tile, {reinterpret_cast<const char*>(data), size})) return 0;
  eg::mapping::TsdfMap again;
  if (!map.tiles().empty() && !again.unpack_tile(tile, map.pack_tile(tile).value())) std::abort();
  (void)map.extract_tile(tile);
  return 0;
}
