// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/star.h"

#include "engine/geometry/interval.h"
#include "engine/geometry/orient.h"

namespace ptin {

bool is_star(const VertexSplit& r, std::span<const RingCorner> ring,
             const HeightEncoding& heights) noexcept {
  const Interval codes{heights.code(r.height_lo), heights.code(r.height_hi)};
  for (const RingCorner& c : ring) {
    const bool is_known = (c.flags & RingCorner::kNoHeight) == 0;
    // Both comparisons of an interval are false for a NaN.
    if (!contains(r.roi, c.position) || !(c.death <= r.error) ||
        (is_known ? !contains(codes, heights.code(c.height)) : c.height != 0)) {
      return false;
    }
  }
  const bool is_closed = has_closed_ring(r);
  const bool has_height = (r.flags & VertexSplit::kVertexVoid) == 0;
  for (std::size_t k = is_closed ? 0 : 1; k < ring.size(); ++k) {
    const RingCorner& from = ring[k == 0 ? ring.size() - 1 : k - 1];
    const RingCorner& to = ring[k];
    const bool has_heights = has_height && ((from.flags | to.flags) & RingCorner::kNoHeight) == 0;
    if (orient(r.u, from.position, to.position) <= 0 ||
        !(has_heights || (from.flags & RingCorner::kVoid) != 0)) {
      return false;
    }
  }
  // Behind the last corner of an open ring there is no triangle.
  return is_closed ||
         (ring.back().death == kLivesOn && (ring.back().flags & RingCorner::kVoid) == 0);
}

}  // namespace ptin
