// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/star.h"

#include "engine/geometry/interval.h"
#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// Whether a corner's angle around u is a half turn or more, from the direction of x on.
bool is_in_lower_half(GridPoint u, GridPoint corner) noexcept {
  return corner.y < u.y || (corner.y == u.y && corner.x < u.x);
}

}  // namespace

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
  int rounds = 0;
  for (std::size_t k = is_closed ? 0 : 1; k < ring.size(); ++k) {
    const RingCorner& from = ring[k == 0 ? ring.size() - 1 : k - 1];
    const RingCorner& to = ring[k];
    const bool has_heights = has_height && ((from.flags | to.flags) & RingCorner::kNoHeight) == 0;
    if (orient(r.u, from.position, to.position) <= 0 ||
        !(has_heights || (from.flags & RingCorner::kVoid) != 0)) {
      return false;
    }
    rounds += is_in_lower_half(r.u, from.position) && !is_in_lower_half(r.u, to.position) ? 1 : 0;
  }
  if (is_closed) {
    return rounds == 1;
  }
  // The domain is convex. Behind the last corner of an open ring there is no triangle.
  const RingCorner& last = ring.back();
  return rounds <= 1 && orient(r.u, ring.front().position, last.position) >= 0 &&
         last.death == kLivesOn && (last.flags & RingCorner::kVoid) == 0;
}

}  // namespace ptin
