// SPDX-License-Identifier: GPL-3.0-or-later
//
// What lives at a level of detail of the stars of pages: no whole rings, but the triangles that live
// and their corners.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "engine/growing_array.h"

namespace ptin {

/// A star of which some triangle lives, or one that is tied.
struct LivingStar {
  GridPoint u;
  HeightBits height = 0;                    ///< Height of u; 0 where it has none.
  HeightBits height_lo = 0, height_hi = 0;  ///< As VertexSplit has them.
  float deviation = 0.0F;                   ///< As VertexSplit has it.
  std::uint16_t rank = 0;                   ///< As VertexSplit has it; of a tied star.
  bool has_height = false;                  ///< Whether u has a height.
  /// Its record has the level's own error, and its corners are the whole ring, which ends at w where
  /// `ends_at_w`, else begins there (storage/star.h). Where the last triangle lives, the first corner
  /// comes once more.
  bool is_tied = false, ends_at_w = false;
  std::uint32_t corner_end = 0;  ///< Behind its last corner.
};

/// A corner of a living triangle, as it comes counter-clockwise around u.
struct LivingCorner {
  enum Flag : std::uint8_t {
    kLives = 1,     ///< The triangle of u, this corner and the next one lives.
    kVoid = 2,      ///< That triangle is void.
    kNoHeight = 4,  ///< The vertex has no height; `height` is 0.
    kTied = 8,      ///< The triangle lives, and dies at the level's own error.
  };
  GridPoint position;
  HeightBits height = 0;
  std::uint8_t flags = 0;
};

/// The stars, and the corners of each one behind those of the one before. Behind a corner with
/// kLives comes another one of the same star.
struct LivingStars {
  GrowingArray<LivingStar> stars;
  GrowingArray<LivingCorner> corners;

  void clear() { keep(0); }
  /// Keeps the first `count` stars.
  void keep(std::size_t count) {
    stars.grow(count);
    corners.grow(count == 0 ? 0 : stars.data()[count - 1].corner_end);
  }
};

}  // namespace ptin
