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
void LivingTies::note_fans(LivingStars& living) {
  LivingCorner* first = living.corners.data();
  for (std::size_t i = 0; i < living.stars.size() && !detail_->is_by_error(); ++i) {
    const LivingStar& star = living.stars.data()[i];
    LivingCorner* const end = living.corners.data() + star.corner_end;
    std::span<LivingCorner> ring(first, end);
    first = end;
    if (!star.is_tied) {
      continue;
    }
    const auto error = static_cast<float>(detail_->level());  // it was one
    if (!detail_->keeps(RecordPlace{error, star.rank, key_of(star.u)})) {
      for (LivingCorner& c : ring) {
        c.flags &= static_cast<std::uint8_t>(~unsigned{LivingCorner::kLives});
      }
      continue;
    }
    if (ring.back().position == ring.front().position) {
      ring = ring.first(ring.size() - 1);
    }
    const GridPoint w = (star.ends_at_w ? ring.back() : ring.front()).position;
    const std::span<const LivingCorner> others =
        star.ends_at_w ? ring.first(ring.size() - 1) : ring.subspan(1);
    for (std::size_t k = 0; k + 1 < others.size(); ++k) {
      fans_.push_back(ascending(w, others[k].position, others[k + 1].position));
    }
  }
}

}  // namespace ptin
