// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts of TINs gathered from living triangles, against refinements: errors, and numbers of vertices
// that cut between records of one error.
#include "engine/query/living/living_tin.h"

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/mesh/link.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"
#include "tests/query/far_file.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using reference::canonical;
using reference::Corners;
using reference::TemporaryStore;

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 30;

/// The TIN of a level in a box, in neighbours whole.
Tin gathered(const Terrain& terrain, const DetailRequest& request, const GridBox& box) {
  QueryContext context({}, terrain.store().path());
  const Detail detail(request, terrain.record_source(), context);
  LivingTin living(terrain, detail);
  LivingPlace place;
  place.box = box;
  EXPECT_TRUE(living.gather(place, kPlenty, context));
  Tin tin = living.release_tin();
  link_tin(tin);
  return tin;
}

Tin refined(const Terrain& terrain, const DetailRequest& detail) {
  RefineRequest request;
  request.detail = detail;
  return terrain.refine(request).tin;
}

DetailRequest of_vertices(std::uint64_t vertices) {
  DetailRequest request;
  request.vertices = vertices;
  return request;
}

DetailRequest of_error(double error) {
  DetailRequest request;
  request.tolerance = error;
  return request;
}

/// By the directory: the pages that it names too many have no triangle of the box.
RC_GTEST_PROP(LivingTin, OfAFileElsewhereIsThatOfTheFileAtHand, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const reference::Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h, 4096, 3, test::small_cells(1));
  const Terrain near(file.open());
  const test::Far far(test::bytes_of(file.path));
  const bool has_directory = far.terrain.store().directory() != nullptr;
  RC_ASSERT(has_directory || near.store().pages().page_count() == 0);
  const GridBox& bounds = h.facts.bounds;
  const auto within = [&](std::int32_t low, std::int32_t high) {
    return low + static_cast<std::int32_t>(random() % (std::uint64_t(high) - low + 1));
  };
  for (int i = 0; i < 6; ++i) {
    GridBox box =
        box_of(GridPoint{within(bounds.min_x, bounds.max_x), within(bounds.min_y, bounds.max_y)});
    box = united(box,
                 GridPoint{within(bounds.min_x, bounds.max_x), within(bounds.min_y, bounds.max_y)});
    const auto vertices = near.t0().vertices.size() + random() % (near.store().record_count() + 2);
    for (const DetailRequest& detail : {DetailRequest{}, of_error(2.0), of_vertices(vertices)}) {
      RC_ASSERT(canonical(gathered(far.terrain, detail, box)) ==
                canonical(gathered(near, detail, box)));
    }
  }
}

/// A window of a file elsewhere: one round for the nodes of its cells, one for its pages.
TEST(LivingTin, OfAWindowElsewhereTakesTwoRounds) {
  const StoreFile& store = reference::built_terrain("mountains_257.tif").store();
  const test::WithDirectory file(store, test::small_cells(40));
  const std::size_t front = test::front_with_directory(file.path);
  const Terrain near = Terrain::open(file.path);
  std::mt19937_64 random(4);
  for (const char* shape : {"window", "polygon"}) {
    for (int i = 0; i < 10; ++i) {
      const double x = 20 + static_cast<double>(random() % 190);
      const double y = 20 + static_cast<double>(random() % 190);
      const auto at = [&](double dx, double dy) {
        return store.facts().map.to_map(x + dx, y + dy);
      };
      RefineRequest request;
      request.form = ResultForm::kMeetingRegion;
      if (shape == std::string("window")) {
        const MapPoint a = at(0, 0), b = at(25, 25);
        request.region =
            Window{std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
      } else {
        request.region = Polygon{{{at(0, 0), at(25, 3), at(20, 25), at(10, 8)}}};
      }
      const test::Far far(file.bytes, front);
      const RefinedTin tin = far.terrain.refine(request);
      EXPECT_EQ(canonical(tin.tin), canonical(near.refine(request).tin));
      EXPECT_LE(far.source->rounds.size(), 2U) << shape << " at " << x << " " << y;
      EXPECT_GT(tin.tin.triangles.size(), 100U);
    }
  }
}

RC_GTEST_PROP(LivingTin, IsTheRefinementAtEveryNumberOfVertices, (std::uint64_t seed)) {
  const reference::Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  const std::uint64_t least = terrain.t0().vertices.size();
  for (int i = 0; i < 6; ++i) {
    const auto vertices =
        *rc::gen::inRange<std::uint64_t>(least, least + terrain.store().record_count() + 2);
    const Tin tin = gathered(terrain, of_vertices(vertices), terrain.store().facts().bounds);
    RC_ASSERT(canonical(tin) == canonical(refined(terrain, of_vertices(vertices))));
  }
}

TEST(LivingTin, OfBuiltTerrainsIsTheirRefinement) {
  for (const char* name : test::some_of({"mountains_257.tif", "coast_257.tif"})) {
    const Terrain& terrain = reference::built_terrain(name);
    const std::uint64_t all = terrain.t0().vertices.size() + terrain.store().record_count();
    std::vector<DetailRequest> levels{{}, of_error(0.0), of_error(7.3)};
    for (const double share : {0.001, 0.03, 0.2, 0.5, 0.51, 0.9}) {
      levels.push_back(of_vertices(static_cast<std::uint64_t>(share * static_cast<double>(all))));
    }
    for (const DetailRequest& level : test::some_of(levels)) {
      const Tin tin = gathered(terrain, level, terrain.store().facts().bounds);
      const Tin wanted = refined(terrain, level);
      EXPECT_EQ(canonical(tin), canonical(wanted)) << name;
      EXPECT_EQ(tin.vertices.size(), wanted.vertices.size());
      EXPECT_EQ(validate(tin), "");
    }
  }
}

bool meets_corners(const Tin& tin, TriangleId t, const GridBox& box) {
  const Triangle& c = tin.triangles[t];
  return meets(
      united(united(box_of(tin.position(c.v[0])), tin.position(c.v[1])), tin.position(c.v[2])),
      box);
}

TEST(LivingTin, OfABoxIsWhatMeetsIt) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  std::mt19937_64 random(3);
  for (int i = 0; i < 12; ++i) {
    const auto at = [&] { return static_cast<std::int32_t>(random() % 257); };
    const GridPoint low{at(), at()};
    const GridBox box{low.x, low.y, low.x + at() / 8, low.y + at() / 4};
    const DetailRequest level =
        i % 2 == 0 ? of_vertices(5000 + 100 * static_cast<unsigned>(i)) : of_error(i / 2.0);
    Tin whole = refined(terrain, level);
    Tin part;
    part.vertices = whole.vertices;
    part.has_height = whole.has_height;
    for (TriangleId t = 0; t < whole.triangles.size(); ++t) {
      if (meets_corners(whole, t, box)) {
        part.triangles.push_back(whole.triangles[t]);
        part.classes.push_back(whole.classes[t]);
      }
    }
    EXPECT_EQ(canonical(gathered(terrain, level, box)), canonical(part));
    EXPECT_FALSE(part.triangles.empty());
  }
}

TEST(LivingTin, IsGatheredWithinItsMemoryOrNotAtAll) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  QueryContext context({}, terrain.store().path());
  const Detail detail(terrain.store());
  LivingTin living(terrain, detail);
  LivingPlace place;
  place.box = terrain.store().facts().bounds;
  const std::uint64_t triangles = refined(terrain, {}).triangles.size();
  EXPECT_FALSE(living.gather(place, LivingTin::bytes_for(triangles) / 2, context));
  EXPECT_TRUE(living.tin().triangles.empty());
  EXPECT_TRUE(living.gather(place, LivingTin::bytes_for(triangles + 1000), context));
  EXPECT_EQ(living.tin().triangles.size(), triangles);
}

}  // namespace
}  // namespace ptin
