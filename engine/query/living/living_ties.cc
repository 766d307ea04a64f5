// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/living_ties.h"

#include <span>

namespace ptin {

namespace {

std::array<VertexKey, 3> ascending(GridPoint a, GridPoint b, GridPoint c) {
  std::array<VertexKey, 3> keys{key_of(a), key_of(b), key_of(c)};
  std::sort(keys.begin(), keys.end());
  return keys;
}

}  // namespace

LivingTies::Keys LivingTies::keys_of(const LivingTriangle& t) {
  return ascending(t.corner[0].position, t.corner[1].position, t.corner[2].position);
}

/// A fan has the triangles of w and two neighbours on the ring. Where a ring begins:
/// storage/star.h.
void LivingTies::note_fans(const StarredRecords& stars) {
  for (std::size_t i = 0; i < stars.size() && !detail_->is_by_error(); ++i) {
    const VertexSplit& r = stars.splits[i];
    if (static_cast<double>(r.error) != detail_->level() || !detail_->keeps(place_of(r))) {
      continue;
    }
    const std::span<const RingCorner> ring = stars.ring(i);
    const bool ends_at_w = (r.flags & VertexSplit::kNoLeft) != 0;
    const GridPoint w = (ends_at_w ? ring.back() : ring.front()).position;
    const std::span<const RingCorner> others =
        ends_at_w ? ring.first(ring.size() - 1) : ring.subspan(1);
    for (std::size_t k = 0; k + 1 < others.size(); ++k) {
      fans_.push_back(ascending(w, others[k].position, others[k + 1].position));
    }
  }
}

}  // namespace ptin
