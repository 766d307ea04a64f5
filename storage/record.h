// SPDX-License-Identifier: GPL-3.0-or-later
//
// The vertex-split record.
#pragma once

#include <cstdint>

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
  HeightBits height = 0;  ///< Height of u; 0 when kVertexVoid.
  GridBox roi;            ///< Saturated.
  HeightBits height_lo =
      0;  ///< Saturated interval of heights, as stored; lo > hi (as codes) when empty.
  HeightBits height_hi = 0;
  float error = 0.0F;      ///< Saturated, rounded outward, height's unit; finite or +infinity.
  float deviation = 0.0F;  ///< Saturated, rounded outward, height's unit.
  std::uint16_t rank = 0;
  std::uint16_t flags = 0;
  [[nodiscard]] bool has_height() const noexcept { return (flags & kVertexVoid) == 0; }  ///< u.
  friend bool operator==(const VertexSplit&, const VertexSplit&) = default;
};

[[nodiscard]] inline Attributes attributes_of(const VertexSplit& r,
                                              const HeightEncoding& heights) noexcept {
  return {r.roi, {heights.code(r.height_lo), heights.code(r.height_hi)}, r.error, r.deviation};
}

}  // namespace ptin
