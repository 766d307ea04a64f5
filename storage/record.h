// SPDX-License-Identifier: GPL-3.0-or-later
//
// The vertex-split record, and its two encodings in bytes: narrow and wide (storage/FORMAT.md,
// "Records").
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "storage/attributes.h"

namespace ptin {

/// One vertex split, `split(w; u, vl, vr)`: the triangles of w from vl counter-clockwise round to
/// vr get u in w's place, and the triangles (u, w, vl) and (u, vr, w) appear. At a border one of
/// the two does not exist (kNoLeft, kNoRight), and vl and vr are the two ends of the fan.
struct VertexSplit {
  enum Flag : std::uint16_t {
    kLeftVoid = 1,    ///< Triangle (u, w, vl) is void.
    kRightVoid = 2,   ///< Triangle (u, vr, w) is void.
    kNoLeft = 4,      ///< Border: (u, w, vl) does not exist.
    kNoRight = 8,     ///< Border: (u, vr, w) does not exist.
    kVertexVoid = 16  ///< u has no height.
  };
  static constexpr std::uint16_t kAllFlags = 31;
  static constexpr std::uint16_t kAnyVoid = kLeftVoid | kRightVoid | kVertexVoid;

  GridPoint u, w, vl, vr;
  HeightBits height = 0;  ///< Of u; 0 when kVertexVoid.
  GridBox roi;            ///< Saturated.
  HeightBits height_lo =
      0;  ///< Saturated interval of heights, as stored; lo > hi (as codes) when empty.
  HeightBits height_hi = 0;
  float error = 0.0F;      ///< Saturated, rounded outward, height's unit; finite or +infinity.
  float deviation = 0.0F;  ///< Saturated, rounded outward, height's unit.
  std::uint16_t rank = 0;
  std::uint16_t flags = 0;
  friend bool operator==(const VertexSplit&, const VertexSplit&) = default;
};

[[nodiscard]] inline Attributes attributes_of(const VertexSplit& r,
                                              const HeightEncoding& heights) noexcept {
  return {r.roi, {heights.code(r.height_lo), heights.code(r.height_hi)}, r.error, r.deviation};
}

/// Narrow records hold references as offsets of 2 x int16 from u, wide ones of 2 x int32.
enum class RecordKind : std::uint8_t { kNarrow = 0, kWide = 1 };
inline constexpr std::size_t kNarrowRecordBytes = 64;
inline constexpr std::size_t kWideRecordBytes = 72;

[[nodiscard]] constexpr std::size_t record_bytes(RecordKind kind) noexcept {
  return kind == RecordKind::kNarrow ? kNarrowRecordBytes : kWideRecordBytes;
}

/// The smallest kind that holds the references of `r`.
[[nodiscard]] RecordKind kind_of(const VertexSplit& r) noexcept;

/// Writes `r` to `out` (record_bytes(kind) bytes). REQUIRES: kind_of(r) <= kind.
void encode_record(const VertexSplit& r, RecordKind kind, std::span<std::byte> out) noexcept;

/// Reads a record. Returns false, and leaves `r` unspecified, when a field cannot be what was
/// written: coordinates off the grid, an empty or off-grid roi, u, w, vl or vr outside of roi,
/// unknown flags, a NaN or negative error or deviation. Every byte pattern is safe to pass.
[[nodiscard]] bool decode_record(std::span<const std::byte> in, RecordKind kind,
                                 VertexSplit& r) noexcept;

/// Reads `out.size()` records that lie one behind the other in `in`, with the checks of
/// decode_record(). Returns the number of records before the first that fails them: out.size() when
/// none fails. That record and those behind it are unspecified in `out`. Cost: about 5 ns a record.
[[nodiscard]] std::size_t decode_records(std::span<const std::byte> in, RecordKind kind,
                                         std::span<VertexSplit> out) noexcept;

}  // namespace ptin
