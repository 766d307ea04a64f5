// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/living_place.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "storage/packed_rtree.h"
#include "storage/page_columns.h"
#include "storage/point_directory.h"

namespace ptin {

namespace {

/// The index is asked where nodes of a large box have more bytes: it leaves out what lies above the
/// level by few nodes.
constexpr std::uint64_t kMostDirectoryBytes = std::uint64_t{64} << 10;

/// Whether a condition is known to ask for a place, and that place lies within a box.
bool asks_within(const StarPredicate& condition, const GridBox& box) {
  constexpr GridBox kEverything{INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX};
  return condition.reach() != kEverything && contains(box, condition.reach());
}

PageId id_of(PageId page) { return page; }
PageId id_of(const DirectoryPage& page) { return page.id; }

bool meets_heights(const LivingTriangle& t, const LivingPlace& place,
                   const HeightEncoding& heights) {
  if (place.heights == kAllHeights && place.steps.empty()) {
    return true;
  }
  if (t.is_void) {
    return false;
  }
  const auto code = [&](std::size_t i) { return heights.code(t.corner[i].height); };
  const Interval spanned{std::min({code(0), code(1), code(2)}),
                         std::max({code(0), code(1), code(2)})};
  return meets(spanned, place.heights) &&
         (place.steps.empty() ||
          !steps_within(place.steps, ordered_height(heights.bits(spanned.lo), heights.type),
                        ordered_height(heights.bits(spanned.hi), heights.type))
               .empty());
}

}  // namespace

bool LivingReader::read(const LivingPlace& place, QueryContext& context, LivingVisitor& visitor) {
  ties_.clear();
  filter_ = {.box = place.box,
             .heights = place.heights,
             .steps = place.steps,
             .also = place.stars,
             .also_of_stars = place.asks_each_star};
  set_level(detail_, filter_);
  if (asks_directory()) {
    std::vector<DirectoryPage> named;
    store_.directory()->find_in(filter_, named, context.cost.io);
    const double records_of_page = static_cast<double>(store_.record_count()) /
                                   static_cast<double>(store_.pages().page_count());
    return take_all<DirectoryPage>(
        named, static_cast<std::uint64_t>(records_of_page * static_cast<double>(named.size())),
        place, context, visitor);
  }
  std::vector<StarPage> found;
  store_.star_index().search_stars(filter_, found, context.cost.io);
  std::vector<PageId> pages;
  std::uint64_t records = 0;
  for (const StarPage& page : found) {
    pages.push_back(page.id);
    records += page.records;
  }
  return take_all<PageId>(pages, records, place, context, visitor);
}

/// Whether the directory is asked instead of the index: it is read in one round, and knows of boxes
/// and of levels alone.
bool LivingReader::asks_directory() const {
  return store_.directory() != nullptr && filter_.heights == kAllHeights && filter_.steps.empty() &&
         (filter_.also == nullptr || asks_within(*filter_.also, filter_.box)) &&
         store_.directory()->bytes_for(filter_.box) <= kMostDirectoryBytes;
}

template <class Page>
bool LivingReader::take_all(std::span<const Page> pages, std::uint64_t records,
                            const LivingPlace& place, QueryContext& context,
                            LivingVisitor& visitor) {
  if (!visitor.expect(records) || !visitor.begin(store_.t0().triangles.size())) {
    return false;
  }
  visit_living(store_.t0(), filter_.level,
               [&](const LivingTriangle& t) { offer(t, place, visitor); });
  std::vector<PageId> ids(pages.size());
  std::transform(pages.begin(), pages.end(), ids.begin(), [](const Page& p) { return id_of(p); });
  store_.pages().announce(ids, context.cost.io);
  for (const Page& page : pages) {
    context.check_stop();
    if (!(filter_.with_ties ? take_tied_page(page, place, context, visitor)
                            : take_page(page, place, context, visitor))) {
      return false;
    }
  }
  if (!visitor.begin(ties_.count())) {
    return false;
  }
  ties_.settle([&](const LivingTriangle& t) { visitor.take(t); });
  return true;
}

template <class Page>
bool LivingReader::take_page(const Page& page, const LivingPlace& place, QueryContext& context,
                             LivingVisitor& visitor) {
  living_.clear();
  context.cost.records_examined += store_.read_living(page, filter_, living_, context.cost.io);
  context.cost.stars_read += living_.stars.size();
  if (!visitor.begin(living_.corners.size())) {
    return false;
  }
  if (visitor.take_stars(living_)) {
    return true;
  }
  visit_living(living_, heights_, [&](const LivingTriangle& t) {
    if (is_wanted(t, place)) {
      visitor.take(t);
    }
  });
  return true;
}

/// The same where the level cuts between records of one error.
template <class Page>
bool LivingReader::take_tied_page(const Page& page, const LivingPlace& place, QueryContext& context,
                                  LivingVisitor& visitor) {
  stars_.clear();
  context.cost.records_examined += store_.read_stars(page, filter_, stars_, context.cost.io);
  context.cost.stars_read += stars_.size();
  ties_.note_fans(stars_);
  context.admit(ties_.bytes());
  if (!visitor.begin(stars_.corners.size() + ties_.bytes() / sizeof(LivingTriangle))) {
    return false;
  }
  visit_living(stars_, detail_, heights_,
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
  if (!ties_.set_aside(t)) {
    visitor.take(t);
  }
}

}  // namespace ptin
