// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/living_place.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/living/floor_cells.h"
#include "storage/packed_rtree.h"
#include "storage/page_columns.h"
#include "storage/point_directory.h"

namespace ptin {

namespace {

/// The index is asked where nodes of a large box have more bytes: it leaves out what lies above the
/// level by few nodes.
constexpr std::uint64_t kMostDirectoryBytes = std::uint64_t{64} << 10;

constexpr GridBox kAllPlaces{INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX};

/// Whether a condition is known to ask for a place, and that place lies within a box.
bool asks_within(const StarPredicate& condition, const GridBox& box) {
  return condition.reach() != kAllPlaces && contains(box, condition.reach());
}

void announce(const StoreFile& store, std::span<const PageId> pages, const GridBox&,
              QueryContext& context) {
  store.announce(pages, context.heights(), context.cost.io);
}
/// The directory knows of no page where its stars end.
void announce(const StoreFile& store, std::span<const DirectoryPage> pages, const GridBox& place,
              QueryContext& context) {
  store.announce(pages, context.cost.io);
  store.announce_heights_around(std::span(&place, 1), context.heights(), context.cost.io);
}

/// The condition of pages with stars across a step, where there are steps.
class PlaceStars final : public StarPredicate {
 public:
  PlaceStars(const LivingPlace& place, const HeightEncoding& heights)
      : place_(place), heights_(heights) {}
  [[nodiscard]] bool may_hold(const StarAttributes& a) const noexcept override {
    return !is_empty(a.heights) && !steps_within_codes(a.heights).empty() &&
           (place_.stars == nullptr || place_.stars->may_hold(a));
  }

 private:
  [[nodiscard]] std::span<const std::uint64_t> steps_within_codes(const Interval& codes) const {
    return steps_within(place_.steps, ordered_height(heights_.bits(codes.lo), heights_.type),
                        ordered_height(heights_.bits(codes.hi), heights_.type));
  }

  const LivingPlace& place_;
  const HeightEncoding& heights_;
};

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
  if (const Floor* const floor = floor_for(terrain_, stars_.detail())) {
    return read_floor(*floor, place, context, visitor);
  }
  stars_.clear();
  const PlaceStars across_steps(place, heights_);
  filter_.box = place.box;
  filter_.heights = place.heights;
  filter_.steps = place.steps;
  filter_.also = place.steps.empty() ? place.stars : &across_steps;
  filter_.each = place.asks_each_star ? place.stars : nullptr;
  set_level(stars_.detail(), filter_);
  store_.announce_heights_around(std::span(&place.box, 1), context.heights(), context.cost.io);
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

/// The full TIN of a raster follows from its heights, of which far fewer pages are read.
bool LivingReader::read_floor(const Floor& floor, const LivingPlace& place, QueryContext& context,
                              LivingVisitor& visitor) {
  const PlaceStars across_steps(place, heights_);
  const StarPredicate* const also = place.steps.empty() ? place.stars : &across_steps;
  FloorWish wish;
  wish.box = place.box;
  wish.may_hold = [&](const GridBox& box, const Interval& codes) {
    const bool asks_heights = place.heights != kAllHeights;
    return (!asks_heights || (!is_empty(codes) && meets(codes, place.heights))) &&
           (also == nullptr || also->may_hold({box, codes, kInfinity, -kInfinity}));
  };
  wish.take_cells = [&](const RasterSquare& square) { return visitor.take_cells(square); };
  const GridBox reach = place.stars == nullptr ? kAllPlaces : place.stars->reach();
  const std::uint64_t samples = floor_samples(floor.facts().shape, intersection(place.box, reach));
  if (!visitor.expect(samples)) {
    return false;
  }
  return visit_floor(
      floor, heights_, wish,
      [&](std::size_t most) {
        context.check_stop();
        return visitor.begin(most);
      },
      [&](const LivingTriangle& t) {
        if (is_wanted(t, place)) {
          visitor.take(t);
        }
      },
      recent_, context.cost);
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
  const auto take = [&](const LivingTriangle& t) { visitor.take(t); };
  stars_.visit_t0([&](const GridBox& box) { return meets(box, place.box); },
                  [&](const LivingTriangle& t) { return is_wanted(t, place); }, take);
  announce(store_, pages, place.box, context);
  for (const Page& page : pages) {
    context.check_stop();
    if (!take_page(page, place, context, visitor)) {
      return false;
    }
  }
  if (!visitor.begin(stars_.count_aside())) {
    return false;
  }
  stars_.settle(take);
  return true;
}

template <class Page>
bool LivingReader::take_page(const Page& page, const LivingPlace& place, QueryContext& context,
                             LivingVisitor& visitor) {
  stars_.read(page, filter_, context);
  context.admit(stars_.bytes_aside());
  const std::size_t aside = stars_.bytes_aside() / sizeof(LivingTriangle);
  if (!visitor.begin(stars_.living().corners.size() + aside)) {
    return false;
  }
  if (!filter_.with_ties && visitor.take_stars(stars_.living())) {
    return true;
  }
  stars_.visit_page([](const GridBox&) { return true; },  // what was read meets the box
                    [&](const LivingTriangle& t) { return is_wanted(t, place); },
                    [&](const LivingTriangle& t) { visitor.take(t); });
  return true;
}

bool LivingReader::is_wanted(const LivingTriangle& t, const LivingPlace& place) const {
  return meets_heights(t, place, heights_) && (!place.wanted || place.wanted(t));
}

}  // namespace ptin
