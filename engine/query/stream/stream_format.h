// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bytes of a stream, structure by structure (storage/FORMAT.md, "Streams").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/mesh/tin.h"
#include "storage/layout.h"

namespace ptin::stream {

inline constexpr std::array<std::uint8_t, 8> kMagic = layout::kStreamMagic;
inline constexpr std::uint16_t kMajorVersion = 1;
inline constexpr std::uint16_t kMinorVersion = 0;

/// The first bytes of a stream; frames follow.
struct Head {
  std::array<std::uint8_t, 8> magic;           //  0
  std::uint16_t major_version, minor_version;  //  8
  std::uint32_t reserved;                      // 12  zero
};
static_assert(sizeof(Head) == 16);

enum class FrameKind : std::uint32_t { kStart = 1, kT0 = 2, kSplits = 3, kEnd = 4 };

/// Before the payload of each frame.
struct FrameHead {
  std::uint32_t kind;
  std::uint32_t sequence;  ///< 0 for the first frame of a stream.
  std::uint32_t bytes;     ///< Bytes of the payload.
  std::uint32_t reserved;  ///< Zero.
  std::uint64_t checksum;  ///< Checksum of bytes 0 to 15 and the payload.
};
static_assert(sizeof(FrameHead) == 24);
inline constexpr std::uint32_t kMaxFrameBytes = 1U << 28;

/// Flag of Start: the stream goes on from another one.
inline constexpr std::uint32_t kIsDelta = 1;

/// Payload of a start frame; the metadata follows. Steps, offsets, origins, heights and bounds are
/// the bits of doubles.
struct Start {
  std::uint64_t fingerprint;                 //   0  of the file
  std::uint32_t height_type, flags;          //   8
  std::uint64_t height_step;                 //  16  double
  std::uint64_t height_offset;               //  24
  std::uint64_t origin_x, origin_y;          //  32
  std::uint64_t step_x, step_y;              //  48
  std::array<std::int32_t, 4> bounds;        //  64
  std::uint64_t min_height, max_height;      //  80
  std::uint64_t base_error, base_deviation;  //  96
  std::uint64_t error, deviation;            // 112  certified before the first split
  std::uint64_t base_vertices;               // 128  of the mesh that splits are applied to
  std::uint64_t base_digest;                 // 136
  std::uint64_t splits;                      // 144  to come
  std::uint64_t metadata_bytes;              // 152
};
static_assert(sizeof(Start) == 160 && offsetof(Start, bounds) == 64 &&
              offsetof(Start, metadata_bytes) == 152);

/// Payload of a T0 frame: counts, then layout::T0Vertex in order of their keys, layout::T0Triangle.
struct T0Counts {
  std::uint32_t vertices, triangles;
};
/// A triangle of T0: as in the file, but for the death.
struct T0Triangle {
  std::array<std::uint32_t, 3> v;
  std::uint32_t is_void;
};
static_assert(sizeof(T0Triangle) == 16);

/// Payload of a frame of splits; their code follows.
struct Splits {
  std::uint32_t count, reserved;
  std::uint64_t error, deviation;  ///< Bits of doubles: certified once the splits are applied.
};
static_assert(sizeof(Splits) == 24);
/// A code holds at most this many splits for each of its bytes: a receiver's memory is bounded by
/// its input.
inline constexpr std::uint64_t kMostSplitsPerByte = 4;
/// A frame has at least a 64th as many splits as the mesh has vertices, or at least 2^20, unless it
/// is the last of its stream: a receiver numbers the mesh anew for each frame, so its time is
/// bounded by its input.
inline constexpr std::uint64_t kLeastShare = 64;
inline constexpr std::uint64_t kMostLeastSplits = std::uint64_t{1} << 20;

/// Payload of an end frame.
struct End {
  /// Splits of this stream; vertices and digest of the mesh.
  std::uint64_t splits, vertices, digest;
};
static_assert(sizeof(End) == 24);

static_assert(layout::kIsPlainBytes<Head> && layout::kIsPlainBytes<FrameHead> &&
              layout::kIsPlainBytes<Start> && layout::kIsPlainBytes<Splits> &&
              layout::kIsPlainBytes<End>);

/// Checksum of a frame: over its head without the checksum, and its payload.
[[nodiscard]] std::uint64_t checksum_of_frame(const FrameHead& head,
                                              std::span<const std::byte> payload);

/// The digest of a vertex. That of a mesh is the sum of the digests of its vertices, modulo 2^64,
/// so it does not depend on their order.
[[nodiscard]] std::uint64_t digest_of(GridPoint position, HeightBits height,
                                      bool has_height) noexcept;
[[nodiscard]] std::uint64_t digest_of(const Tin& tin) noexcept;

/// The same mesh with vertices in order of their keys: the numbering that both sides of a stream
/// can make alone. REQUIRES: no removed vertex or triangle. Cost: O(n log n).
[[nodiscard]] Tin numbered_by_key(const Tin& tin);

}  // namespace ptin::stream
