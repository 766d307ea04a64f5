// SPDX-License-Identifier: GPL-3.0-or-later
//
// T0 as files and streams bring it.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "storage/star.h"
#include "storage/store_facts.h"

namespace ptin {

/// T0: the coarsest TIN, as stored. Triangle corners are indices into `vertices`,
/// counter-clockwise.
struct CoarsestTin {
  struct V {
    GridPoint position;
    HeightBits height;
    std::uint32_t has_height;  ///< 0 or 1.
  };
  struct T {
    std::uint32_t v[3];
    std::uint32_t is_void;   ///< 0 or 1.
    float death = kLivesOn;  ///< As RingCorner::death.
  };
  std::vector<V> vertices;
  std::vector<T> triangles;
};

/// True when a triangle of T0 is void or a vertex of T0 has no height.
[[nodiscard]] bool has_void(const CoarsestTin& t0) noexcept;

/// What is wrong with a T0, as a sentence; null when nothing is. A sound T0 has vertices within the
/// bounds, finite heights, triangles whose corners are vertices and different, and no surface
/// triangle with a corner without a height.
[[nodiscard]] const char* fault_in(const CoarsestTin& t0, const StoreFacts& facts) noexcept;

}  // namespace ptin
