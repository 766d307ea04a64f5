// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/star.h"

#include "engine/geometry/interval.h"
#include "storage/ring_check.h"

namespace ptin {

bool is_star(const VertexSplit& r, std::span<const RingCorner> ring,
             const HeightEncoding& heights) noexcept {
  const Interval codes{heights.code(r.height_lo), heights.code(r.height_hi)};
  RingCheck check(r.has_height());
  for (const RingCorner& c : ring) {
    // Both comparisons of an interval are false for a NaN.
    if (!contains(r.roi, c.position) || !(c.death <= r.error) ||
        (c.has_height() ? !contains(codes, heights.code(c.height)) : c.height != 0)) {
      return false;
    }
    check.add({.x = std::int64_t{c.position.x} - r.u.x,
               .y = std::int64_t{c.position.y} - r.u.y,
               .is_void = c.is_void(),
               .has_height = c.has_height()});
  }
  return has_closed_ring(r) ? check.is_closed_ring()
                            : check.is_open_ring() && ring.back().death == kLivesOn;
}

}  // namespace ptin
