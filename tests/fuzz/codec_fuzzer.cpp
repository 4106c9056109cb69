// The image decoders against arbitrary bytes: the first byte chooses the codec, the next two the size expected.
#include <cstdint>
#include <cstdlib>

#include "common/codec/colour_codec.hpp"
#include "common/codec/depth_codec.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 3) return 0;
  const int width = 1 + data[1] % 64;
  const int height = 1 + data[2] % 64;
  const std::span<const std::uint8_t> payload(data + 3, size - 3);
  const auto decode = [&] {
    switch (data[0] % 3) {
      case 0:
        return eg::codec::decode_depth(payload, width, height);
      case 1:
        return eg::codec::decode_colour(payload, eg::codec::ColourEncoding::jpeg, width, height);
      default:
        return eg::codec::decode_colour(payload, eg::codec::ColourEncoding::png, width, height);
    }
  };
  const auto image = decode();
  if (image && (image->cols != width || image->rows != height)) std::abort();
  return 0;
}
