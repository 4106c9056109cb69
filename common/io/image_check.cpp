#include <cstdint>
#include <string_view>

#include "common/io/crc.hpp"
#include "common/io/image_file.hpp"

namespace eg::io {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n"sv;
constexpr std::string_view kJpegSignature = "\xff\xd8\xff"sv;

std::uint8_t byte_at(std::string_view bytes, std::size_t offset) { return static_cast<std::uint8_t>(bytes[offset]); }

std::uint32_t big_endian_32(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = (value << 8) | byte_at(bytes, offset + i);
  return value;
}

/// A PNG is a row of chunks: length, type, data, checksum of type and data.
base::Status check_png(std::string_view bytes) {
  constexpr std::size_t kFraming = 12;
  for (std::size_t offset = kPngSignature.size(); bytes.size() - offset >= kFraming;) {
    const std::size_t length = big_endian_32(bytes, offset);
    if (length > bytes.size() - offset - kFraming) break;
    const std::string_view type_and_data = bytes.substr(offset + 4, 4 + length);
    if (crc32<kCrcIso3309>(type_and_data) != big_endian_32(bytes, offset + 8 + length))
      return base::fail("PNG fails its checksum");
    if (type_and_data.starts_with("IEND")) return {};
    offset += kFraming + length;
  }
  return base::fail("PNG is cut short");
}

/// A JPEG is a row of marker segments with a length, and entropy-coded data after each start of scan, in which 0xff is
/// followed by 0x00 or a restart marker (ITU-T T.81, annex B).
base::Status check_jpeg(std::string_view bytes) {
  constexpr std::uint8_t kEndOfImage = 0xd9;
  const auto stands_alone = [](std::uint8_t code) {
    return code == 0x00 || code == 0x01 || code == 0xff || (code >= 0xd0 && code <= 0xd8);
  };
  for (std::size_t offset = 2; offset + 1 < bytes.size();) {
    const std::uint8_t code = byte_at(bytes, offset + 1);
    if (byte_at(bytes, offset) != 0xff || code == 0xff) {
      ++offset;
    } else if (code == kEndOfImage) {
      return {};
    } else if (stands_alone(code)) {
      offset += 2;
    } else if (offset + 4 > bytes.size()) {
      break;
    } else {
      offset += 2 + (big_endian_32(bytes, offset) & 0xffff);
    }
  }
  return base::fail("JPEG is cut short");
}

}  // namespace

base::Status check_image_is_whole(std::string_view bytes) {
  if (bytes.empty()) return base::fail("file is empty");
  if (bytes.starts_with(kPngSignature)) return check_png(bytes);
  if (bytes.starts_with(kJpegSignature)) return check_jpeg(bytes);
  return base::fail("file is neither PNG nor JPEG");
}

}  // namespace eg::io
