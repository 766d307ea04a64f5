// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/living_place.h"

#include <algorithm>

#include "storage/packed_rtree.h"

namespace ptin {

namespace {

std::array<VertexKey, 3> ascending(VertexKey a, VertexKey b, VertexKey c) {
  std::array<VertexKey, 3> keys{a, b, c};
  std::sort(keys.begin(), keys.end());
  return keys;
}

bool meets_heights(const LivingTriangle& t, const LivingPlace& place,
                   const HeightEncoding& heights) {
  if (place.heights == kAllHeights && place.spans == nullptr) {
    return true;
  }
  if (t.is_void) {
    return false;
  }
  const auto code = [&](std::size_t i) { return heights.code(t.corner[i].height); };
  const Interval spanned{std::min({code(0), code(1), code(2)}),
                         std::max({code(0), code(1), code(2)})};
  return meets(spanned, place.heights) &&
         (place.spans == nullptr || place.spans->may_hold(spanned));
}

}  // namespace

bool LivingReader::read(const LivingPlace& place, QueryContext& context, LivingVisitor& visitor) {
  undecided_.clear();
  fans_.clear();
  filter_ = {place.box,   place.heights, detail_.level(),     !detail_.is_by_error(),
             place.stars, place.spans,   place.asks_each_star};
  std::vector<StarPage> pages;
  store_.star_index().search_stars(filter_, pages, context.cost.io);
  std::vector<PageId> ids(pages.size());
  std::uint64_t records = 0;
  for (std::size_t i = 0; i < pages.size(); ++i) {
    ids[i] = pages[i].id;
    records += pages[i].records;
  }
  if (!visitor.expect(records) || !visitor.begin(store_.t0().triangles.size())) {
    return false;
  }
  visit_living(store_.t0(), filter_.level,
               [&](const LivingTriangle& t) { offer(t, place, visitor); });
  store_.pages().announce(ids, context.cost.io);
  for (const PageId page : ids) {
    context.check_stop();
    if (!(filter_.with_ties ? take_tied_page(page, place, context, visitor)
                            : take_page(page, place, context, visitor))) {
      return false;
    }
  }
  return take_undecided(visitor);
}

bool LivingReader::take_page(PageId page, const LivingPlace& place, QueryContext& context,
                             LivingVisitor& visitor) {
  living_.clear();
  context.cost.records_examined += store_.read_living(page, filter_, living_, context.cost.io);
  context.cost.stars_read += living_.stars.size();
  if (!visitor.begin(living_.corners.size())) {
    return false;
  }
  visit_living(living_, heights_, [&](const LivingTriangle& t) {
    if (is_wanted(t, place)) {
      visitor.take(t);
    }
  });
  return true;
}

/// The same where the level cuts between records of one error.
bool LivingReader::take_tied_page(PageId page, const LivingPlace& place, QueryContext& context,
                                  LivingVisitor& visitor) {
  stars_.clear();
  context.cost.records_examined += store_.read_stars(page, filter_, stars_, context.cost.io);
  context.cost.stars_read += stars_.size();
  if (!visitor.begin(stars_.corners.size())) {
    return false;
  }
  for (std::size_t i = 0; i < stars_.size(); ++i) {
    const VertexSplit& r = stars_.splits[i];
    if (static_cast<double>(r.error) == filter_.level && detail_.keeps(place_of(r))) {
      add_fan(r, stars_.ring(i));
    }
  }
  visit_living(
      stars_, filter_.level, heights_,
      [&](const VertexSplit& r) { return detail_.keeps(place_of(r)); },
      [&](const LivingTriangle& t) { offer(t, place, visitor); });
  return true;
}

bool LivingReader::is_wanted(const LivingTriangle& t, const LivingPlace& place) const {
  return meets_heights(t, place, heights_) && (!place.wanted || place.wanted(t));
}

void LivingReader::offer(const LivingTriangle& t, const LivingPlace& place,
                         LivingVisitor& visitor) {
  if (!meets(box_of(t), place.box) || !is_wanted(t, place)) {
    return;
  }
  if (filter_.with_ties && static_cast<double>(t.death) == filter_.level) {
    undecided_.push_back(t);
  } else {
    visitor.take(t);
  }
}

/// Notes the triangles that a record replaces: those of w and two neighbours on the ring. Where a
/// ring begins: storage/star.h.
void LivingReader::add_fan(const VertexSplit& r, std::span<const RingCorner> ring) {
  const bool ends_at_w = (r.flags & VertexSplit::kNoLeft) != 0;
  const VertexKey w = key_of((ends_at_w ? ring.back() : ring.front()).position);
  const std::span<const RingCorner> others =
      ends_at_w ? ring.first(ring.size() - 1) : ring.subspan(1);
  for (std::size_t k = 0; k + 1 < others.size(); ++k) {
    fans_.push_back(ascending(w, key_of(others[k].position), key_of(others[k + 1].position)));
  }
}

/// Hands out the triangles that die at the level's own error, but for those that a record kept
/// replaces.
bool LivingReader::take_undecided(LivingVisitor& visitor) {
  if (!visitor.begin(undecided_.size())) {
    return false;
  }
  std::sort(fans_.begin(), fans_.end());
  for (const LivingTriangle& t : undecided_) {
    const Keys keys = ascending(key_of(t.corner[0].position), key_of(t.corner[1].position),
                                key_of(t.corner[2].position));
    if (!std::binary_search(fans_.begin(), fans_.end(), keys)) {
      visitor.take(t);
    }
  }
  return true;
}

}  // namespace ptin
