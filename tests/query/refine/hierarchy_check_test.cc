// SPDX-License-Identifier: GPL-3.0-or-later
//
// What check_hierarchy() finds: sound stores are sound, in one cell and in many, and where it finds
// nothing no question meets a record that does not fit.
#include "engine/query/refine/hierarchy_check.h"

#include <algorithm>
#include <functional>
#include <random>
#include <span>
#include <stop_token>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"
#include "tests/query/random_predicate.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/support/least_memory.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::TemporaryStore;

HierarchyReport checked(const Hierarchy& h, std::uint64_t memory = std::uint64_t{1} << 30) {
  const TemporaryStore file(h);
  HierarchyRequest request;
  request.limits.memory_bytes = memory;
  return Terrain(file.open()).check_hierarchy(request);
}

std::string first_of(const HierarchyReport& report) {
  return report.faults.empty() ? std::string()
                               : report.faults[0].where + ": " + report.faults[0].what;
}

std::string name_of(const VertexSplit& r) {
  return "record of vertex (" + std::to_string(r.u.x) + ", " + std::to_string(r.u.y) + ")";
}

TEST(HierarchyCheck, FindsNothingInSoundHierarchies) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Hierarchy h = reference::random_hierarchy(seed);
    const HierarchyReport report = checked(h);
    EXPECT_TRUE(report.is_sound()) << seed << " " << first_of(report);
    EXPECT_EQ(report.records, h.records.size());
    EXPECT_EQ(report.cells, 1U);
  }
}

TEST(HierarchyCheck, FindsNothingInWhatWasBuilt) {
  for (const auto& [name, max_error] :
       test::some_of<std::pair<std::string, double>>({{"mountains_257.tif", 0.0},
                                                      {"coast_257.tif", 2.0},
                                                      {"coast_257.tif", 0.0},
                                                      {"ground_points.csv", 0.0}})) {
    const Terrain& terrain = reference::built_terrain(name, max_error);
    const HierarchyReport report = terrain.check_hierarchy({});
    EXPECT_TRUE(report.is_sound()) << name << " " << first_of(report);
    EXPECT_EQ(report.records, terrain.store().record_count());
  }
}

TEST(HierarchyCheck, LooksAtEachRecordOnceInAnyMemory) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  const auto check = [&](std::uint64_t memory) {
    HierarchyRequest request;
    request.limits.memory_bytes = memory;
    double done = 0.0;
    request.progress = [&](double share) {
      EXPECT_GT(share, done);
      done = share;
    };
    const HierarchyReport report = terrain.check_hierarchy(request);
    EXPECT_TRUE(report.is_sound()) << first_of(report);
    EXPECT_EQ(report.records, terrain.store().record_count());
    EXPECT_EQ(done, 1.0);
    return report.cells;
  };
  EXPECT_EQ(check(std::uint64_t{1} << 30), 1U);
  EXPECT_GT(check(std::uint64_t{4} << 20), 10U);
}

TEST(HierarchyCheck, IsRefusedWhereOnePlaceDoesNotFit) {
  HierarchyRequest request;
  request.limits.memory_bytes = 1 << 10;
  try {
    (void)reference::built_terrain("coast_257.tif").check_hierarchy(request);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource_exhausted);
    EXPECT_NE(e.message().find("more memory"), std::string::npos) << e.message();
  }
}

TEST(HierarchyCheck, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  HierarchyRequest request;
  request.limits.stop = source.get_token();
  try {
    (void)reference::built_terrain("coast_257.tif").check_hierarchy(request);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

class DamagedHierarchy : public ::testing::Test {
 protected:
  /// The records, coarsest first.
  static Hierarchy made() {
    std::mt19937_64 random(5);
    Hierarchy h =
        reference::simplify(reference::random_grid(random, 14, 14, 3, 0.1), random, {0.02, true});
    std::stable_sort(h.records.begin(), h.records.end(),
                     [](const VertexSplit& a, const VertexSplit& b) { return a.rank > b.rank; });
    return h;
  }
  /// The first record from the finest on, or from the coarsest on, that passes the test.
  VertexSplit& finest(const std::function<bool(const VertexSplit&)>& is_fit) {
    return *std::find_if(h_.records.rbegin(), h_.records.rend(), is_fit);
  }
  VertexSplit& coarsest(const std::function<bool(const VertexSplit&)>& is_fit) {
    return *std::find_if(h_.records.begin(), h_.records.end(), is_fit);
  }
  void expect_told(const std::string& words, const VertexSplit& named) const {
    const HierarchyReport report = checked(h_);
    for (const VerifyFault& fault : report.faults) {
      if (fault.what.find(words) != std::string::npos &&
          (fault.where + fault.what)
                  .find("vertex (" + std::to_string(named.u.x) + ", " + std::to_string(named.u.y) +
                        ")") != std::string::npos) {
        EXPECT_NE(fault.where.find("page "), std::string::npos) << fault.where;
        EXPECT_NE(fault.where.find("record of vertex ("), std::string::npos) << fault.where;
        return;
      }
    }
    ADD_FAILURE() << words << " of " << name_of(named) << " is not among " << report.faults.size()
                  << " faults: " << first_of(report);
  }
  std::span<RingCorner> ring_of(const VertexSplit& r) {
    const auto& all = h_.stars.splits;
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const VertexSplit& s) { return s.u == r.u; });
    return h_.stars.ring(static_cast<std::size_t>(found - all.begin()));
  }
  /// Whoever reads the stars of the page sees it.
  void expect_page_refused() const {
    const std::string first = first_of(checked(h_));
    EXPECT_NE(first.find("holds values that no program wrote"), std::string::npos) << first;
  }
  static bool has_heights(const VertexSplit& r) {
    return (r.flags & VertexSplit::kAnyVoid) == 0 && r.height_lo != r.height_hi;
  }

  Hierarchy h_ = made();
};

TEST_F(DamagedHierarchy, IsSoundAsItIs) { EXPECT_TRUE(checked(h_).is_sound()); }

TEST_F(DamagedHierarchy, HasARegionThatDoesNotHoldItsPolygon) {
  VertexSplit& r = finest([](const VertexSplit& s) {
    GridBox own = united(united(united(box_of(s.u), s.w), s.vl), s.vr);
    return !(own == s.roi) && s.rank == 0;
  });
  r.roi = united(united(united(box_of(r.u), r.w), r.vl), r.vr);
  expect_page_refused();
}

TEST_F(DamagedHierarchy, HasARegionThatDoesNotHoldWhatNeedsIt) {
  VertexSplit& r = coarsest([](const VertexSplit& s) {
    return !(united(united(united(box_of(s.u), s.w), s.vl), s.vr) == s.roi);
  });
  r.roi = united(united(united(box_of(r.u), r.w), r.vl), r.vr);
  expect_told("region of influence", r);
}

TEST_F(DamagedHierarchy, HasARegionBeyondThatOfWhatItNeeds) {
  VertexSplit& r = finest([&](const VertexSplit& s) { return !(s.roi == h_.facts.bounds); });
  r.roi = h_.facts.bounds;
  expect_told("does not hold its own", r);
}

TEST_F(DamagedHierarchy, HasHeightsThatDoNotHoldItsPolygon) {
  VertexSplit& r = finest([](const VertexSplit& s) { return has_heights(s) && s.rank == 0; });
  r.height_lo = r.height_hi = r.height;
  expect_page_refused();
}

TEST_F(DamagedHierarchy, HasHeightsBeyondThoseOfWhatItNeeds) {
  VertexSplit& r = finest(has_heights);
  r.height_hi = h_.facts.heights.bits(h_.facts.heights.code(r.height_hi) + 4000);
  h_.facts.max_height = 1e4;
  expect_told("do not hold its own", r);
}

TEST_F(DamagedHierarchy, HasAnErrorOrADeviationAboveThatOfWhatItNeeds) {
  const auto is_finite = [](const VertexSplit& s) { return s.rank == 0 && s.error < 1e6; };
  for (const bool is_error : {true, false}) {
    h_ = made();
    VertexSplit& r = finest(is_finite);
    (is_error ? r.error : r.deviation) = 1e9F;
    expect_told(is_error ? "whose error" : "whose deviation", r);
    h_ = made();
    VertexSplit& needed = coarsest([](const VertexSplit&) { return true; });
    (is_error ? needed.error : needed.deviation) = 0.0F;
    expect_told(is_error ? "whose error, 0, is below its own" : "whose deviation, 0, is below",
                needed);
  }
}

TEST_F(DamagedHierarchy, HasErrorsExchanged) {
  VertexSplit& a = h_.records.front();
  VertexSplit& b = finest([&](const VertexSplit& s) { return s.error < a.error; });
  std::swap(a.error, b.error);
  expect_told("whose error", b);
}

TEST_F(DamagedHierarchy, HasARankThatIsNotBelowThatOfWhatItNeeds) {
  VertexSplit& r = h_.records.front();
  r.rank = 0;
  const HierarchyReport report = checked(h_);
  EXPECT_FALSE(report.is_sound());
  EXPECT_NE(first_of(report).find("falling rank"), std::string::npos) << first_of(report);
}

TEST_F(DamagedHierarchy, HasASplitWithoutItsFan) {
  h_.records.erase(h_.records.begin());
  const std::string first = first_of(checked(h_));
  EXPECT_TRUE(first.find("does not find its fan") != std::string::npos ||
              first.find("where no record that comes before it") != std::string::npos)
      << first;
}

TEST_F(DamagedHierarchy, HasAStarThatItsSplitDoesNotMake) {
  const auto has_middle = [&](const VertexSplit& s) {
    const auto ring = ring_of(s);
    return (s.flags & VertexSplit::kAnyVoid) == 0 && ring.size() > 4 && ring[2].flags == 0 &&
           ring[2].height != s.height;
  };
  VertexSplit& r = finest(has_middle);
  ring_of(r)[2].height = r.height;  // no corner that its split names
  expect_told("its star is not the one that its split makes", r);
}

TEST_F(DamagedHierarchy, HasTrianglesThatDieAtAnotherError) {
  const auto dies = [&](const VertexSplit& s, bool is_wanted) {
    const auto ring = ring_of(s);
    return std::find_if(ring.begin(), ring.end(), [&](const RingCorner& c) {
      return (c.death > 0.0F) == is_wanted && (c.death > 0.0F || c.death == kLivesOn);
    });
  };
  const auto is_closed = [&](bool is_wanted) {
    return [&, is_wanted](const VertexSplit& s) {
      return has_closed_ring(s) && s.error > 0.0F && dies(s, is_wanted) != ring_of(s).end();
    };
  };
  dies(coarsest(is_closed(true)), true)->death = 0.0F;
  EXPECT_NE(first_of(checked(h_)).find("is said to die at 0, and its error is"), std::string::npos);
  h_ = made();
  dies(coarsest(is_closed(true)), true)->death = kLivesOn;
  EXPECT_NE(first_of(checked(h_)).find("is said to live on"), std::string::npos);
  h_ = made();
  dies(finest(is_closed(false)), false)->death = 0.0F;
  EXPECT_NE(first_of(checked(h_)).find("triangles are said to die, and records replace"),
            std::string::npos);
  h_ = made();
  for (CoarsestTin::T& t : h_.t0.triangles) t.death = kLivesOn;
  EXPECT_NE(first_of(checked(h_)).find("is said to live on"), std::string::npos);
}

TEST_F(DamagedHierarchy, HasClassesThatDoNotFitItsHeights) {
  VertexSplit& r = finest([](const VertexSplit& s) {
    return (s.flags & (VertexSplit::kVertexVoid | VertexSplit::kLeftVoid | VertexSplit::kNoLeft)) ==
           0;
  });
  r.flags |= VertexSplit::kVertexVoid;
  r.height = 0;
  expect_page_refused();
}

TEST_F(DamagedHierarchy, IsReportedUpToTheLargestNumberOfFaults) {
  for (VertexSplit& r : h_.records) r.error = r.rank == 0 ? 1e9F : 0.0F;
  const TemporaryStore file(h_);
  HierarchyRequest request;
  request.max_faults = 3;
  const HierarchyReport report = Terrain(file.open()).check_hierarchy(request);
  EXPECT_EQ(report.faults.size(), 3U);
  EXPECT_TRUE(report.stopped_early);
}

/// Puts one attribute wrong, mostly to something plausible.
void damage_attribute(std::mt19937_64& random, VertexSplit& r, const VertexSplit& other,
                      const GridBox& bounds) {
  const GridBox own = united(united(united(box_of(r.u), r.w), r.vl), r.vr);
  switch (random() % 10) {
    case 0:
      r.roi = own;
      break;
    case 1:
      r.roi = united(own, other.roi);
      break;
    case 2:
      r.roi = bounds;
      break;
    case 3:  // a page holds no interval without u's height
      if ((r.flags & VertexSplit::kVertexVoid) == 0) r.height_lo = r.height;
      break;
    case 4:
      if ((r.flags & VertexSplit::kVertexVoid) == 0) r.height_hi = r.height;
      break;
    case 5:
      r.error = other.error;
      break;
    case 6:
      r.deviation = other.deviation;
      break;
    case 7:
      std::swap(r.error, r.deviation);
      break;
    case 8:
      r.rank = other.rank;
      break;
    default:
      r.rank = static_cast<std::uint16_t>(r.rank + random() % 3 - 1);
      break;
  }
}

/// Asks for refinements of many kinds; no sound store fails one.
void expect_answers(const Terrain& tin, std::mt19937_64& random, std::size_t records) {
  MovingWindow window = tin.moving_window({});
  for (int i = 0; i < 8; ++i) {
    RefineRequest request;
    if (i == 0) {
      request.detail.vertices = tin.t0().vertices.size() + random() % (records + 1);
    }
    const PredicatePtr p = reference::random_predicate(random, tin.store().facts(), 2);
    if (i > 1) request.also = p.get();
    (void)tin.refine(request);
    (void)window.move_to(p);
  }
}

RC_GTEST_PROP(HierarchyCheck, FindsWhateverAQuestionWouldFailOn, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  Hierarchy h = reference::random_hierarchy(seed);
  if (h.records.empty()) return;
  for (std::size_t i = 1 + random() % 2; i > 0; --i) {
    damage_attribute(random, h.records[random() % h.records.size()],
                     h.records[random() % h.records.size()], h.facts.bounds);
  }
  const TemporaryStore file(h);
  if (!verify_store(file.path).is_sound()) return;
  const Terrain tin(file.open());
  // In few cells and in many it finds something or nothing.
  const bool is_sound = tin.check_hierarchy({}).is_sound();
  HierarchyRequest little;
  little.limits.memory_bytes = reference::least_memory([&](std::uint64_t bytes) {
    HierarchyRequest request;
    request.limits.memory_bytes = bytes;
    (void)tin.check_hierarchy(request);
  });
  RC_ASSERT(tin.check_hierarchy(little).is_sound() == is_sound);
  if (!is_sound) return;
  try {
    expect_answers(tin, random, h.records.size());
  } catch (const Error& e) {
    RC_FAIL(std::string("called sound, but: ") + e.what());
  }
}

}  // namespace
}  // namespace ptin
