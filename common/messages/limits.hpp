#pragma once

#include <cstddef>
#include <cstdint>

/// What decode() accepts at most, beside the bounds in common/features/features.hpp. No array is allocated before its
/// count is known to be within its bound and its bytes are known to be there, so that a message never costs more memory
/// than a small multiple of its own size.
namespace eg::messages {

inline constexpr std::size_t kMaxName = 64;   ///< characters of service, host, state and camera names
inline constexpr std::size_t kMaxText = 200;  ///< characters of reasons and other sentences

inline constexpr int kMaxImagePixels = 1 << 24;
inline constexpr int kMaxImageBytes = 1 << 24;  ///< of one compressed image

inline constexpr int kMaxGraphNodes = 100'000;    ///< keyframes or landmarks
inline constexpr int kMaxGraphEdges = 1'000'000;  ///< observations, covisibility edges or relative poses
inline constexpr int kMaxRelativePoses = 1000;    ///< of one keyframe
inline constexpr int kMaxSnapshotParts = 100'000;
inline constexpr int kMaxMeshVertices = 65'535;  ///< their indices have 16 bits
inline constexpr int kMaxMeshTriangles = 1'000'000;
inline constexpr int kMaxAssociations = 8192;        ///< of one keyframe's directions with landmarks
inline constexpr int kMaxMapLandmarks = 10'000'000;  ///< points, lines or planes of a map archive
inline constexpr int kMaxPyramidLevel = 63;
inline constexpr int kMaxResendNumbers = 64;       ///< messages asked for at once
inline constexpr int kMaxSkippedFrames = 100'000;  ///< frames of a recording that could not be read

/// Bound on positions and distances, metres: no building is larger, and cells of a centimetre still count in 32 bits.
inline constexpr double kMaxLength = 10'000.0;
inline constexpr double kMaxPixel = 1e6;  ///< bound on image coordinates; features may lie outside the image

/// Bound on identities of keyframes and landmarks: the one after it is still a number.
inline constexpr std::int32_t kMaxIdentity = 1 << 30;

/// Bound on times, sequence numbers and versions: their differences cannot overflow.
inline constexpr std::int64_t kMaxCounter = std::int64_t{1} << 60;

}  // namespace eg::messages
