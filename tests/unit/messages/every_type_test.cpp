#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/messages/allocations.hpp"
#include "tests/unit/messages/flatten.hpp"
#include "tests/unit/messages/random_messages.hpp"

namespace eg::messages {
namespace {

/// RGBD is lossless only with PNG; all other types have one encoding.
template <typename T>
Bytes exact_encode(const T& value) {
  if constexpr (std::is_same_v<T, image::RgbdFrame>) {
    return encode(compress(value, {codec::ColourEncoding::png}));
  } else {
    return encode(value);
  }
}

void write_int32(Bytes& bytes, std::size_t at, std::int32_t value) {
  for (int i = 0; i < 4; ++i) {
    bytes[at + static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> (24 - 8 * i));
  }
}

/// What every type promises of every input: an error, or a value without non-finite numbers that is encoded again.
template <typename T>
bool refused_or_sane(const Bytes& bytes) {
  const auto value = decode<T>(bytes);
  if (!value) return !value.error().message.empty();
  return flatten(*value).all_finite() && decode<T>(exact_encode(*value)).has_value();
}

template <typename T>
class EveryType : public testing::Test {};

using Types =
    testing::Types<image::RgbdFrame, features::FrameFeatures, tracking::PoseEstimate, tracking::PoseCorrection,
                   egraph::Keyframe, egraph::GraphUpdate, egraph::GraphSnapshot, mapping::MeshChunk, GraphRequest,
                   MeshRequest, ResendRequest, tracking::KeyframeLinks, tracking::LandmarkPositions, Acknowledge,
                   EndOfStream, Control, ControlReply, ServiceStatus>;
TYPED_TEST_SUITE(EveryType, Types);

TYPED_TEST(EveryType, ComesBackBitForBit) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    base::Random random(seed);
    const auto value = random_value<TypeParam>(random);
    const auto decoded = decode<TypeParam>(exact_encode(value));
    ASSERT_TRUE(decoded) << "seed " << seed << ": " << decoded.error().message;
    ASSERT_EQ(flatten(*decoded), flatten(value)) << "seed " << seed;
  }
}

TYPED_TEST(EveryType, IsRefusedWhenCutAnywhere) {
  base::Random random(1);
  const Bytes bytes = exact_encode(random_value<TypeParam>(random));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    // A copy of its own, so that the address sanitizer sees every read beyond the end.
    const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_FALSE(decode<TypeParam>(cut)) << size << " of " << bytes.size() << " bytes";
  }
}

TYPED_TEST(EveryType, IsRefusedWithBytesBehindIt) {
  base::Random random(2);
  Bytes bytes = exact_encode(random_value<TypeParam>(random));
  bytes.push_back(0);
  ASSERT_FALSE(decode<TypeParam>(bytes));
}

TYPED_TEST(EveryType, SaysWhenTheTypeIsWrong) {
  base::Random random(3);
  Bytes bytes = exact_encode(random_value<TypeParam>(random));
  bytes[7] ^= 1U;
  const auto decoded = decode<TypeParam>(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_TRUE(decoded.error().message.starts_with("wrong type: ")) << decoded.error().message;
}

TYPED_TEST(EveryType, SurvivesFlippedBits) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    base::Random random(seed);
    const Bytes bytes = exact_encode(random_value<TypeParam>(random));
    for (int attempt = 0; attempt < 50; ++attempt) {
      Bytes damaged = bytes;
      for (int flips = 1 + random.index(4); flips > 0; --flips) {
        const int bit = random.index(8 * static_cast<int>(bytes.size()));
        damaged[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      }
      ASSERT_TRUE(refused_or_sane<TypeParam>(damaged)) << "seed " << seed << " attempt " << attempt;
    }
  }
}

TYPED_TEST(EveryType, LetsNoNonFiniteNumberThrough) {
  constexpr std::array<std::array<std::uint8_t, 8>, 2> kPatterns = {
      {{0x7f, 0xf8, 0, 0, 0, 0, 0, 0}, {0xff, 0xf0, 0, 0, 0, 0, 0, 0}}};  // NaN, -infinity
  base::Random random(4);
  const Bytes bytes = exact_encode(random_value<TypeParam>(random));
  for (std::size_t at = 8; at + 8 <= bytes.size(); ++at) {
    for (const auto& pattern : kPatterns) {
      Bytes damaged = bytes;
      std::copy(pattern.begin(), pattern.end(), damaged.begin() + static_cast<std::ptrdiff_t>(at));
      ASSERT_TRUE(refused_or_sane<TypeParam>(damaged)) << "offset " << at;
    }
  }
}

TYPED_TEST(EveryType, AllocatesNothingForHugeOrNegativeLengths) {
  constexpr std::size_t kSmall = 4096;
  base::Random random(5);
  const Bytes bytes = exact_encode(TypeParam{random_value<TypeParam>(random)});
  const std::size_t size = std::min<std::size_t>(bytes.size(), 100);
  for (std::size_t at = 8; at + 4 <= size; ++at) {
    for (const std::int32_t length :
         {std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min(), -1, 1'000'000}) {
      Bytes damaged(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      write_int32(damaged, at, length);
      reset_largest_allocation();
      const auto decoded = decode<TypeParam>(damaged);
      const std::size_t largest = largest_allocation();
      ASSERT_LT(largest, kSmall) << "offset " << at << " length " << length;
    }
  }
}

TYPED_TEST(EveryType, RefusesNoise) {
  base::Random random(6);
  for (int size = 0; size < 300; ++size) {
    Bytes noise(static_cast<std::size_t>(size));
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random.index(256));
    ASSERT_FALSE(decode<TypeParam>(noise));
  }
}

}  // namespace
}  // namespace eg::messages
