// SPDX-License-Identifier: GPL-3.0-or-later
//
// The theorem of lifetimes (engine/DESIGN.md, section 2.10) over stores: the living triangles of a
// level are those of its refinement, each once.
#include "engine/query/living/living_triangle.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/query/living/living_page.h"
#include "engine/query/questions.h"
#include "storage/packed_rtree.h"
#include "storage/sample_heights.h"
#include "storage/short_float.h"
#include "tests/query/built_terrain.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using reference::canonical;
using reference::Corners;
using reference::TemporaryStore;

Corners corners_of(const LivingTriangle& t) {
  std::array<VertexKey, 3> k{};
  for (std::size_t i = 0; i < 3; ++i) {
    k[i] = key_of(t.corner[i].position);
  }
  std::rotate(k.begin(), std::min_element(k.begin(), k.end()), k.end());
  return {k[0], k[1], k[2], t.is_void ? TriangleClass::kVoid : TriangleClass::kSurface};
}

LivingStars living_of(const StoreFile& store, PageId page, const LivingFilter& filter) {
  LivingStars living;
  const auto look = [&](const RecordPage& p) { take_living(p, filter, living); };
  IoCounters counters;
  SampleHeights samples;
  store.look_at(page, look, samples, counters);
  return living;
}

/// The triangles of whole stars that live at a level.
std::vector<LivingTriangle> living_of_rings(const StarredRecords& stars, double level) {
  std::vector<LivingTriangle> living;
  for (std::size_t i = 0; i < stars.size(); ++i) {
    const VertexSplit& r = stars.splits[i];
    const auto ring = stars.ring(i);
    for (std::size_t k = 0; k + (has_closed_ring(r) ? 0 : 1) < ring.size(); ++k) {
      if (r.error > level && ring[k].death <= level) {
        LivingTriangle t;
        t.corner[0].position = r.u;
        t.corner[1].position = ring[k].position;
        t.corner[2].position = ring[(k + 1) % ring.size()].position;
        t.is_void = (ring[k].flags & RingCorner::kVoid) != 0;
        living.push_back(t);
      }
    }
  }
  return living;
}

/// All triangles that live at a level, sorted. A negative level: the finest TIN.
std::vector<Corners> living(const StoreFile& store, double level) {
  std::vector<Corners> result;
  const auto take = [&](const LivingTriangle& t) { result.push_back(corners_of(t)); };
  visit_living(store.t0(), level, take);
  LivingFilter filter;
  filter.level = level;
  for (std::uint64_t p = 0; p < store.pages().page_count(); ++p) {
    visit_living(living_of(store, PageId{p}, filter), store.facts().heights, take);
  }
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<Corners> refined_corners(const Terrain& terrain, double level) {
  RefineRequest request;
  if (level >= 0) {
    request.detail.tolerance = level;
  }
  return canonical(terrain.refine(request).tin);
}

RC_GTEST_PROP(LivingTriangles, AreThoseOfTheRefinementAtEveryError, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const reference::Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  std::vector<double> levels{-1.0, 0.0, 1e30};
  for (int i = 0; i < 4 && !h.records.empty(); ++i) {
    const double error = h.stars.splits[random() % h.records.size()].error;
    levels.push_back(error);  // which leaves out the records of just this error
    levels.push_back(error * 0.99);
  }
  for (const double level : levels) {
    RC_ASSERT(living(terrain.store(), level) == refined_corners(terrain, level));
  }
}

TEST(LivingTriangles, OfBuiltTerrainsAreThoseOfTheirRefinements) {
  for (const char* name : test::some_of({"mountains_257.tif", "coast_257.tif"})) {
    for (const double max_error : {0.0, 2.0}) {
      const Terrain& terrain = reference::built_terrain(name, max_error);
      for (const double level : test::some_of({-1.0, 0.0, 1.0, 5.0, 7.3, 40.0, 1e6})) {
        ASSERT_EQ(living(terrain.store(), level), refined_corners(terrain, level))
            << name << " left out " << max_error << " at " << level;
      }
    }
  }
}

TEST(LivingTriangles, OfALevelAreFoundWhereTheyMeetABox) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  const StoreFile& store = terrain.store();
  std::mt19937_64 random(3);
  for (int i = 0; i < 20; ++i) {
    const auto at = [&] { return static_cast<std::int32_t>(random() % 257); };
    const GridPoint low{at(), at()};
    LivingFilter filter;
    filter.box = {low.x, low.y, low.x + 9, low.y + 5};
    filter.level = i % 2 == 0 ? -1.0 : 3.0;
    std::vector<Corners> all, found;
    const auto take_into = [&](std::vector<Corners>& out) {
      return [&](const LivingTriangle& t) {
        if (meets(box_of(t), filter.box)) out.push_back(corners_of(t));
      };
    };
    IoCounters counters;
    SampleHeights samples;
    std::vector<StarPage> pages;
    store.star_index().search_stars(filter, pages, counters);
    for (const StarPage& page : pages) {
      visit_living(living_of(store, page.id, filter), store.facts().heights, take_into(found));
    }
    for (std::uint64_t p = 0; p < store.pages().page_count(); ++p) {
      StarredRecords stars;
      store.read_starred(PageId{p}, stars, samples, counters);
      std::ranges::for_each(living_of_rings(stars, filter.level), take_into(all));
    }
    std::sort(all.begin(), all.end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, all);
    EXPECT_FALSE(all.empty());
  }
}

/// Takes every page, or the first few: the widest ones first.
class Collector final : public BestStarVisitor {
 public:
  explicit Collector(std::size_t most) : most_(most) {}
  [[nodiscard]] Merit bound(const StarAttributes& a) const override {  // of few different values
    return {static_cast<double>((a.box.max_x - a.box.min_x) / 16), key_of({a.box.min_x, 0})};
  }
  Merit visit(PageId page, const StarAttributes& a) override {
    EXPECT_FALSE(!bounds.empty() && bounds.back().is_below(bound(a))) << "pages come best first";
    bounds.push_back(bound(a));
    pages.push_back(page);
    return pages.size() == most_ ? kBestMerit : kNoMerit;
  }
  std::vector<PageId> pages;
  std::vector<Merit> bounds;

 private:
  std::size_t most_;
};

TEST(LivingTriangles, AreFoundBestFirstOnTheSamePages) {
  const StoreFile& store = reference::built_terrain("mountains_257.tif").store();
  for (const double level : {-1.0, 3.0}) {
    StarFilter filter;
    filter.box = {60, 50, 180, 160};
    filter.level = level;
    IoCounters counters, of_all, of_few;
    std::vector<StarPage> found;
    store.star_index().search_stars(filter, found, counters);
    Collector all(0), few(1);
    store.star_index().search_stars_best_first(filter, all, kNoMerit, of_all);
    store.star_index().search_stars_best_first(filter, few, kNoMerit, of_few);
    ASSERT_GT(found.size(), 10U);
    EXPECT_EQ(of_all.index_nodes, counters.index_nodes);
    EXPECT_LT(of_few.index_nodes, counters.index_nodes);
    EXPECT_EQ(few.pages, std::vector<PageId>(all.pages.begin(), all.pages.begin() + 1));
    std::sort(all.pages.begin(), all.pages.end());
    ASSERT_EQ(all.pages.size(), found.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(all.pages[i], found[i].id);
  }
}

TEST(ShortNumbers, TellALevelAsTheErrorsThemselvesDo) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    const auto bits = static_cast<ShortBits>(random() % (kShortInfinity + 1U));
    const auto other = static_cast<ShortBits>(random() % (kShortInfinity + 1U));
    const double level = i % 3 == 0 ? static_cast<double>(short_value(other))
                                    : static_cast<double>(short_value(other)) * 1.001;
    EXPECT_EQ(short_value(bits) > level, bits > level_bits(level));
    EXPECT_EQ(short_value(bits) <= level, death_bits(short_value(bits)) <= level_bits(level) + 1);
  }
  EXPECT_EQ(level_bits(-1.0), -1);
  EXPECT_LE(death_bits(kLivesOn), level_bits(-1.0) + 1);
  EXPECT_GT(death_bits(0.0F), level_bits(-1.0) + 1);
}

}  // namespace
}  // namespace ptin
