// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/triangle_at.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/query/living/floor_cells.h"
#include "engine/query/living/level_stars.h"
#include "engine/query/walk/spot_set.h"
#include "storage/packed_rtree.h"
#include "storage/point_directory.h"

namespace ptin {

namespace {

/// With fewer records of the region for each of its spots, the region is read as a whole. Else the
/// pages of each spot are: a spot reads a few pages and leaves out most of their stars.
constexpr double kRecordsOfSpot = 128;
/// So few spots of a region that is not dense are looked for one by one.
constexpr std::size_t kFewSpots = 16;
/// Spots that are looked for together in a far file, wherever they lie: some pages too many are
/// read, but few rounds are waited for.
constexpr std::size_t kFewFarSpots = 1024;
/// So many of the pages that a directory names are read first for each spot: of a thousand spots of the
/// finest TIN all but a few need no more.
constexpr std::size_t kFirstPages = 8;

std::array<VertexKey, 3> keys_of(const LivingTriangle& t) {
  std::array<VertexKey, 3> keys{};
  for (std::size_t i = 0; i < 3; ++i) {
    keys[i] = key_of(t.corner[i].position);
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

bool is_preferred(const LivingTriangle& a, const LivingTriangle& b) {
  return a.is_void != b.is_void ? !a.is_void : keys_of(a) < keys_of(b);
}

/// Takes a triangle as the answer for a spot that it holds, if it is the better one.
void offer(const LivingTriangle& t, Spot q, TriangleAt& at) {
  if (at.is_inside) {
    return;
  }
  const std::array<Int128, 3> weight = weights_of(t, q);
  if (weight[0] < 0 || weight[1] < 0 || weight[2] < 0) {
    return;
  }
  if (!at.is_found || is_preferred(t, at.triangle)) {
    at.triangle = t;
    at.is_found = true;
  }
  at.is_inside = weight[0] > 0 && weight[1] > 0 && weight[2] > 0;
}

class SpotStars final : public StarPredicate {
 public:
  explicit SpotStars(const SpotSet& spots) : spots_(spots) {}
  [[nodiscard]] bool may_hold(const StarAttributes& a) const noexcept override {
    return spots_.holds_spot(a.box);
  }

 private:
  const SpotSet& spots_;
};

/// The smallest grid box around spots.
GridBox reach_of(std::span<const Spot> spots) {
  GridBox reach;
  for (const Spot s : spots) {
    reach = united(reach, box_around(s));
  }
  return reach;
}

constexpr std::int64_t kWithinUnit = (std::int64_t{1} << kSpotBits) - 1;
bool is_position(Spot s) { return (s.x & kWithinUnit) == 0 && (s.y & kWithinUnit) == 0; }
/// Sides of a raster's triangles often lie along such a line.
bool is_on_grid_line(Spot s) { return (s.x & kWithinUnit) == 0 || (s.y & kWithinUnit) == 0; }

double area_of(const GridBox& b) {
  return (static_cast<double>(b.max_x) - b.min_x + 1) *
         (static_cast<double>(b.max_y) - b.min_y + 1);
}

class Finder {
 public:
  Finder(const OpenedTerrain& terrain, const Detail& detail, std::uint64_t held,
         QueryContext& context)
      : store_(terrain.store()), context_(context), held_(held), stars_(store_, detail) {
    set_level(detail, filter_);
  }
  void find(std::span<const Spot> spots, std::span<TriangleAt> found);

 private:
  class SmallestFirst;
  void find_one(Spot spot, TriangleAt& found);
  void find_together(std::span<const Spot> spots, std::span<TriangleAt> found);
  void find_by_directory(std::span<const Spot> spots, std::span<TriangleAt> found);
  void search(const SpotSet& set);
  void announce_far();
  void read(PageId page);
  void admit() const { context_.admit(held_ + stars_.bytes_aside()); }
  [[nodiscard]] bool is_dense(const GridBox& reach, std::size_t spots) const;
  template <class Source>
  void offer_all(const SpotSet& set, const Source& source, std::span<const Spot> spots,
                 std::span<TriangleAt> found) const;

  const StoreFile& store_;
  QueryContext& context_;
  std::uint64_t held_;
  LivingFilter filter_;
  std::vector<StarPage> pages_;
  LevelStars stars_;
};

void Finder::search(const SpotSet& set) {
  pages_.clear();
  filter_.box = set.reach();
  const SpotStars also(set);
  filter_.also = &also;
  store_.star_index().search_stars(filter_, pages_, context_.cost.io);
  filter_.also = nullptr;
  context_.check_stop();
}

/// Near ones are not announced: most of them are in memory, and each call costs.
void Finder::announce_far() {
  if (!store_.pages().is_far()) {
    return;
  }
  std::vector<PageId> ids;
  ids.reserve(pages_.size());
  for (const StarPage& page : pages_) {
    ids.push_back(page.id);
  }
  store_.announce(ids, context_.heights(), context_.cost.io);
}

void Finder::read(PageId page) { stars_.read(page, filter_, context_); }

/// Offers each triangle of a source to the spots in its box.
template <class Source>
void Finder::offer_all(const SpotSet& set, const Source& source, std::span<const Spot> spots,
                       std::span<TriangleAt> found) const {
  const auto take = [&](const LivingTriangle& t) {
    set.for_each_in(box_of(t), [&](std::size_t i) { offer(t, spots[i], found[i]); });
  };
  source(take);
}

/// Whether so many spots are many for the records of their box, were the records spread evenly.
bool Finder::is_dense(const GridBox& reach, std::size_t spots) const {
  const double share = area_of(reach) / area_of(store_.facts().bounds);
  return static_cast<double>(store_.record_count()) * share <
         kRecordsOfSpot * static_cast<double>(spots);
}

/// Takes the pages that may hold one spot, those with the smallest boxes of stars first: the smaller
/// a box, the more of it do its triangles cover. So few nodes of the index are looked at, and few
/// pages. Nothing is cut off before a triangle is found, so the order is free.
class Finder::SmallestFirst final : public BestStarVisitor {
 public:
  SmallestFirst(Finder& finder, Spot spot, TriangleAt& found)
      : finder_(finder), spot_(spot), found_(found) {}
  [[nodiscard]] Merit bound(const StarAttributes& a) const override { return {-area_of(a.box)}; }
  [[nodiscard]] Merit bound_of_node(const StarAttributes& a, std::uint32_t level) const override {
    // The larger children of a node hold the spot: their boxes are about an eighth of its own.
    constexpr double kShareOfChild = 1.0 / 8;
    double area = area_of(a.box) * kShareOfChild;
    for (; level > 0; --level) {
      area *= kShareOfChild;
    }
    return {-area};
  }
  /// On a vertex no triangle ends the search, and most positions of the grid have one.
  [[nodiscard]] bool wants_all() const override { return is_position(spot_); }
  void will_visit(std::span<const GridBox> stars) override {
    QueryContext& context = finder_.context_;
    finder_.store_.announce_heights(stars, context.heights(), context.cost.io);
  }
  Merit visit(PageId page, const StarAttributes&) override {
    finder_.context_.check_stop();
    finder_.read(page);
    finder_.stars_.visit_page([&](const GridBox& box) { return contains(box, spot_); },
                              [&](const LivingTriangle& t) { offer(t, spot_, found_); });
    finder_.admit();
    return found_.is_inside ? kBestMerit : kNoMerit;
  }

 private:
  Finder& finder_;
  Spot spot_;
  TriangleAt& found_;
};

void Finder::find_one(Spot spot, TriangleAt& found) {
  stars_.clear();
  const auto take = [&](const LivingTriangle& t) { offer(t, spot, found); };
  stars_.visit_t0([&](const GridBox& box) { return contains(box, spot); }, take);
  if (found.is_inside) {
    return;
  }
  filter_.box = box_around(spot);
  store_.announce_heights_around(std::span(&filter_.box, 1), context_.heights(), context_.cost.io);
  SmallestFirst visitor(*this, spot, found);
  store_.star_index().search_stars_best_first(filter_, visitor, kNoMerit, context_.cost.io);
  stars_.settle(take);
}

/// Looks for the spots of a dense region together; else for those of its parts.
void Finder::find(std::span<const Spot> spots, std::span<TriangleAt> found) {
  const bool is_far = store_.pages().is_far() && spots.size() <= kFewFarSpots;
  if (is_far && store_.directory() != nullptr) {
    find_by_directory(spots, found);
  } else if (spots.size() > 1 && (is_far || is_dense(reach_of(spots), spots.size()))) {
    find_together(spots, found);
  } else if (spots.size() > kFewSpots) {
    const std::size_t half = spots.size() / 2;
    find(spots.first(half), found.first(half));
    find(spots.subspan(half), found.subspan(half));
  } else {
    for (std::size_t i = 0; i < spots.size(); ++i) {
      find_one(spots[i], found[i]);
    }
  }
}

/// Takes the pages that the directory names for the spots: of each spot the likeliest first, then the
/// others where no triangle holds it within.
void Finder::find_by_directory(std::span<const Spot> spots, std::span<TriangleAt> found) {
  const SpotSet set(spots, filter_.level);
  const auto may_hold_one = [&](const GridBox& box) { return set.may_hold_spot(box); };
  stars_.clear();
  offer_all(
      set, [&](const auto& take) { stars_.visit_t0(may_hold_one, take); }, spots, found);
  std::vector<GridBox> places;
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    if (!found[i].is_inside) {
      places.push_back(box_around(spots[i]));
      asked.push_back(i);
    }
  }
  store_.announce_heights_around(places, context_.heights(), context_.cost.io);
  std::vector<std::vector<DirectoryPage>> named(places.size());
  store_.directory()->find(places, filter_, named, context_.cost.io);
  context_.check_stop();
  const auto by_id = [](const DirectoryPage& a, const DirectoryPage& b) { return a.id < b.id; };
  filter_.box = set.reach();
  std::vector<DirectoryPage> pages, taken;  // by id
  for (const bool is_first : {true, false}) {
    pages.clear();
    for (std::size_t k = 0; k < asked.size(); ++k) {
      if (!found[asked[k]].is_inside) {
        const bool some = is_first && !is_on_grid_line(spots[asked[k]]);
        const std::size_t count = some ? std::min(kFirstPages, named[k].size()) : named[k].size();
        pages.insert(pages.end(), named[k].begin(), named[k].begin() + count);
      }
    }
    std::sort(pages.begin(), pages.end(), by_id);
    const auto is_done = [&](const DirectoryPage& p) {
      return std::binary_search(taken.begin(), taken.end(), p, by_id);
    };
    pages.erase(
        std::unique(pages.begin(), pages.end(),
                    [](const DirectoryPage& a, const DirectoryPage& b) { return a.id == b.id; }),
        pages.end());
    std::erase_if(pages, is_done);
    store_.announce(pages, context_.cost.io);
    if (is_first) store_.announce_heights_around(places, context_.heights(), context_.cost.io);
    for (const DirectoryPage& page : pages) {
      context_.check_stop();
      stars_.read(page, filter_, context_);
      offer_all(
          set, [&](const auto& take) { stars_.visit_page(may_hold_one, take); }, spots, found);
      admit();
    }
    taken.swap(pages);
  }
  offer_all(
      set, [&](const auto& take) { stars_.settle(take); }, spots, found);
}

void Finder::find_together(std::span<const Spot> spots, std::span<TriangleAt> found) {
  const SpotSet set(spots, filter_.level);
  const auto may_hold_one = [&](const GridBox& box) { return set.may_hold_spot(box); };
  const auto from_t0 = [&](const auto& take) { stars_.visit_t0(may_hold_one, take); };
  const auto from_page = [&](const auto& take) { stars_.visit_page(may_hold_one, take); };
  const auto from_aside = [&](const auto& take) { stars_.settle(take); };
  stars_.clear();
  offer_all(set, from_t0, spots, found);
  search(set);
  announce_far();
  for (const StarPage& page : pages_) {
    context_.check_stop();
    read(page.id);
    offer_all(set, from_page, spots, found);
    admit();
  }
  offer_all(set, from_aside, spots, found);
}

/// The triangles at spots of the full TIN of a raster.
void find_on_floor(const StoreFile& store, const Floor& floor, std::span<const Spot> spots,
                   std::span<TriangleAt> found, Floor::Recent& recent, QueryContext& context) {
  FloorAtSpots triangles(floor, store.facts().heights, recent);
  triangles.announce(spots, context.cost.io);
  for (std::size_t i = 0; i < spots.size(); ++i) {
    if (i % kStopInterval == 0) {
      context.check_stop();
    }
    if (const auto within = triangles.within(spots[i], context.cost)) {
      found[i] = {within->living(store.facts().heights), true, true};
    } else {
      found[i] = triangle_on_sides(triangles, spots[i], context.cost);
    }
  }
}

}  // namespace

TriangleAt triangle_on_sides(FloorAtSpots& triangles, Spot spot, QueryCost& cost) {
  TriangleAt found;
  triangles.visit(
      spot, [&](const LivingTriangle& t) { offer(t, spot, found); }, cost);
  return found;
}

void find_triangles(const OpenedTerrain& terrain, const Detail& detail, std::span<const Spot> spots,
                    std::span<TriangleAt> found, std::uint64_t held, QueryContext& context,
                    Floor::Recent* recent) {
  std::fill(found.begin(), found.end(), TriangleAt{});
  if (const Floor* const floor = floor_for(terrain, detail)) {
    Floor::Recent own;
    find_on_floor(terrain.store(), *floor, spots, found, recent != nullptr ? *recent : own,
                  context);
  } else if (!spots.empty()) {
    Finder(terrain, detail, held, context).find(spots, found);
  }
}

}  // namespace ptin
