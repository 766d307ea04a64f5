// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of sight against the full TIN in rationals.
#include "engine/query/sight/sight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "tests/query/built_terrain.h"
#include "tests/query/sight/sight_oracle.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using reference::nasty_spot;
using reference::Rational;
using reference::SmallTerrain;
using reference::true_sight;
using reference::TrueSight;

/// A request and a pair in which touching, grazing and lines along edges are common.
struct SightCase {
  SightRequest request;
  SightPair pair;
  Spot p, q;
  double bend = 0.0;
};

double nasty_end(std::mt19937_64& random, bool absolute) {
  if (random() % 4 == 0) {
    return std::uniform_real_distribution<double>(absolute ? -5 : -1, absolute ? 40 : 8)(random);
  }
  return static_cast<double>(random() % (absolute ? 31 : 4));
}

SightCase random_question(std::mt19937_64& random, const SmallTerrain& t) {
  SightCase asked;
  const StoreFacts& f = t.terrain->store().facts();
  const SpotMap map(f.map, f.bounds);
  do {
    asked.pair.a = map.map(nasty_spot(random, t.full));
    asked.pair.b = map.map(nasty_spot(random, t.full));
    asked.p = *map.spot(asked.pair.a);
    asked.q = *map.spot(asked.pair.b);
  } while (asked.p == asked.q);
  asked.request.absolute = random() % 3 == 0;
  asked.request.curvature.coefficient = random() % 2 == 0 ? 0.0 : 0.85714;
  asked.request.curvature.earth_diameter = random() % 2 == 0 ? 2 * 6378137.0 : 60.0;
  asked.pair.height_a = nasty_end(random, asked.request.absolute);
  asked.pair.height_b = nasty_end(random, asked.request.absolute);
  const double dx = asked.pair.b.x - asked.pair.a.x;
  const double dy = asked.pair.b.y - asked.pair.a.y;
  const double length = std::sqrt(dx * dx + dy * dy);
  asked.bend = asked.request.curvature.drop_at(length);
  return asked;
}

void check_verdict(const TrueSight& truth, const SightResult& found) {
  RC_ASSERT(found.state_a == truth.state_p);
  RC_ASSERT(found.state_b == truth.state_q);
  if (!truth.defined) {
    RC_ASSERT(found.verdict == SightVerdict::kUndefined);
    return;
  }
  RC_ASSERT(found.verdict == (truth.hidden ? SightVerdict::kHidden : SightVerdict::kVisible));
  RC_ASSERT(found.exact);
}

void check_measures(const TrueSight& truth, const SightResult& found) {
  if (!truth.defined) {
    return;
  }
  RC_ASSERT(std::isnan(found.clearance_min) == !truth.clearance.has_value());
  if (truth.clearance) {
    const double clearance = truth.clearance->convert_to<double>();
    RC_ASSERT(std::abs(found.clearance_min - clearance) < 1e-9);
    RC_ASSERT(found.clearance_min == found.clearance_max);
  }
  RC_ASSERT(found.obstruction.has_value() == truth.hidden);
  if (truth.hidden) {
    RC_ASSERT(std::abs(found.obstruction->share - truth.first) < 1e-6);
  }
  RC_ASSERT(std::abs(found.void_length - truth.void_share * found.length) < 1e-6);
}

RC_GTEST_PROP(Sight, AgreesWithEveryTriangleInRationals, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain t(seed);
  for (int i = 0; i < 5; ++i) {
    const SightCase asked = random_question(random, t);
    const TrueSight truth = true_sight(t, asked.p, asked.pair.height_a, asked.q,
                                       asked.pair.height_b, asked.request.absolute, asked.bend);
    const SightResult found = t.terrain->sight(asked.pair, asked.request);
    check_verdict(truth, found);
    check_measures(truth, found);
  }
}

RC_GTEST_PROP(Sight, SolversAgreeWithEveryTriangleWhateverTheyAskedBefore, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain t(seed);
  const SightCase first = random_question(random, t);
  SightRequest request = first.request;
  request.curvature.coefficient = 0.0;
  request.verdict_only = random() % 2 == 0;
  SightSolver solver(*t.terrain, request, random() % 3 == 0 ? 0 : random() % 100);
  for (int i = 0; i < 5; ++i) {
    const SightCase asked = random_question(random, t);
    const TrueSight truth = true_sight(t, asked.p, asked.pair.height_a, asked.q,
                                       asked.pair.height_b, request.absolute, 0.0);
    const SightResult found = solver.solve(asked.pair);
    check_verdict(truth, found);
    if (!request.verdict_only) {
      check_measures(truth, found);
    }
  }
}

/// An answer that left something out: whatever it does tell is true.
void check_certificate(const TrueSight& truth, const SightResult& found) {
  if (found.verdict != SightVerdict::kUndecided) {
    RC_ASSERT(truth.defined == (found.verdict != SightVerdict::kUndefined));
  }
  if (!truth.defined) {
    return;
  }
  if (found.verdict != SightVerdict::kUndecided) {
    RC_ASSERT(found.verdict == (truth.hidden ? SightVerdict::kHidden : SightVerdict::kVisible));
  }
  if (!std::isnan(found.clearance_min) && truth.clearance) {
    const double clearance = truth.clearance->convert_to<double>();
    RC_ASSERT(found.clearance_min <= clearance + 1e-9);
    RC_ASSERT(found.clearance_max >= clearance - 1e-9);
  }
  if (!std::isnan(found.void_length)) {
    RC_ASSERT(std::abs(found.void_length - truth.void_share * found.length) < 1e-6);
  }
}

RC_GTEST_PROP(Sight, IsNeverWrongWhenItStopsEarly, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain t(seed);
  for (int i = 0; i < 5; ++i) {
    SightCase asked = random_question(random, t);
    const TrueSight truth = true_sight(t, asked.p, asked.pair.height_a, asked.q,
                                       asked.pair.height_b, asked.request.absolute, asked.bend);
    asked.request.verdict_only = random() % 2 == 0;
    asked.request.wavelength = random() % 3 == 0 ? 1.0 : 0.0;
    const bool is_level = random() % 2 == 0;
    if (is_level && random() % 2 == 0) {
      asked.request.detail.tolerance = static_cast<double>(random() % 8);
    } else if (is_level) {
      const StoreFile& store = t.terrain->store();
      asked.request.detail.vertices =
          store.t0().vertices.size() + random() % (store.record_count() + 2);
    }
    if (!is_level || random() % 3 == 0) {
      asked.request.budget = random() % 60;
    }
    const SightResult found = t.terrain->sight(asked.pair, asked.request);
    check_certificate(truth, found);
    if (found.exact) {
      check_verdict(truth, found);
      if (!asked.request.verdict_only) {
        check_measures(truth, found);
      }
    }
  }
}

/// The truth is that of a file that holds everything.
RC_GTEST_PROP(Sight, OfAllVerticesIsExact, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain t(seed);
  SightCase asked = random_question(random, t);
  const SightResult exact = t.terrain->sight(asked.pair, asked.request);
  asked.request.detail.vertices = std::uint64_t{1} << 40;
  const SightResult all = t.terrain->sight(asked.pair, asked.request);
  RC_ASSERT(all.verdict == exact.verdict);
  RC_ASSERT(all.exact == exact.exact);
  RC_ASSERT(all.clearance_at.has_value() == exact.clearance_at.has_value());
  if (all.clearance_at) RC_ASSERT(all.clearance_min == exact.clearance_min);
}

RC_GTEST_PROP(Sight, IsNeverWrongOfAFileThatIsNotExact, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain t(seed);
  const bool has_voids = std::any_of(t.full.classes.begin(), t.full.classes.end(),
                                     [](auto c) { return c != TriangleClass::kSurface; });
  RC_PRE(!has_voids);  // the certificate is of where both are surface
  const SmallTerrain rough(seed, 1.0 + static_cast<double>(random() % 4));
  for (int i = 0; i < 5; ++i) {
    SightCase asked = random_question(random, t);
    const TrueSight truth = true_sight(t, asked.p, asked.pair.height_a, asked.q,
                                       asked.pair.height_b, asked.request.absolute, asked.bend);
    asked.request.verdict_only = random() % 2 == 0;
    check_certificate(truth, rough.terrain->sight(asked.pair, asked.request));
  }
}

/// The same question by splits.
SightResult by_splits(const Terrain& t, const SightPair& pair, const SightRequest& request) {
  return t.sight(pair, request, AnswerBy::kSplits);
}

/// The same number, up to the last bits of what is weighed in another triangle beside an edge.
bool is_same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b)) ||
         std::abs(a - b) <= 1e-12 * (1 + std::abs(a) + std::abs(b));
}
bool is_same(const std::optional<SightPoint>& a, const std::optional<SightPoint>& b) {
  return a.has_value() == b.has_value() &&
         (!a || (is_same(a->share, b->share) && is_same(a->height, b->height)));
}

void check_same(const SightResult& stars, const SightResult& splits) {
  RC_ASSERT(stars.verdict == splits.verdict);
  RC_ASSERT(stars.exact == splits.exact);
  RC_ASSERT(stars.state_a == splits.state_a);
  RC_ASSERT(stars.state_b == splits.state_b);
  RC_ASSERT(stars.certified_deviation == splits.certified_deviation);
  RC_ASSERT(is_same(stars.clearance_min, splits.clearance_min));
  RC_ASSERT(is_same(stars.clearance_max, splits.clearance_max));
  RC_ASSERT(is_same(stars.void_length, splits.void_length));
  RC_ASSERT(stars.fresnel_ratio.has_value() == splits.fresnel_ratio.has_value());
  if (stars.fresnel_ratio) RC_ASSERT(is_same(*stars.fresnel_ratio, *splits.fresnel_ratio));
}

RC_GTEST_PROP(Sight, ByStarsIsBySplits, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain t(seed);
  for (int i = 0; i < 20; ++i) {
    SightCase asked = random_question(random, t);
    asked.request.wavelength = random() % 3 == 0 ? 1.0 : 0.0;
    asked.request.verdict_only = asked.request.wavelength == 0 && random() % 3 == 0;
    const SightResult stars = t.terrain->sight(asked.pair, asked.request);
    const SightResult splits = by_splits(*t.terrain, asked.pair, asked.request);
    RC_ASSERT(stars.cost.records_retrieved == 0u);
    RC_ASSERT(splits.cost.stars_read == 0u);
    check_same(stars, splits);
    if (!asked.request.verdict_only) {
      RC_ASSERT(is_same(stars.obstruction, splits.obstruction));
    }
  }
}

/// Where something is left out, what one way tells does not contradict what the other tells.
RC_GTEST_PROP(Sight, ByStarsAtALevelAgreesWithSplits, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain t(seed, random() % 3 == 0 ? 2.0 : 0.0);
  const auto is_decided = [](const SightResult& r) {
    return r.verdict != SightVerdict::kUndecided;
  };
  const auto agree = [](double a, double b) {
    return std::isnan(a) || std::isnan(b) || is_same(a, b);
  };
  for (int i = 0; i < 20; ++i) {
    SightCase asked = random_question(random, t);
    asked.request.wavelength = random() % 3 == 0 ? 1.0 : 0.0;
    if (random() % 2 == 0) {
      asked.request.detail.tolerance = static_cast<double>(random() % 8);
    } else {
      const StoreFile& store = t.terrain->store();
      asked.request.detail.vertices =
          store.t0().vertices.size() + random() % (store.record_count() + 2);
    }
    const SightResult stars = t.terrain->sight(asked.pair, asked.request);
    const SightResult splits = by_splits(*t.terrain, asked.pair, asked.request);
    RC_ASSERT(stars.state_a == splits.state_a);
    RC_ASSERT(stars.state_b == splits.state_b);
    RC_ASSERT(!is_decided(stars) || !is_decided(splits) || stars.verdict == splits.verdict);
    RC_ASSERT(!(stars.clearance_min > splits.clearance_max + 1e-9));
    RC_ASSERT(!(splits.clearance_min > stars.clearance_max + 1e-9));
    RC_ASSERT(agree(stars.void_length, splits.void_length));
  }
}

/// Real pairs: from points on sides and vertices too, over a solver with a coarse level.
class SightByBothWays : public ::testing::TestWithParam<const char*> {};

TEST_P(SightByBothWays, IsTheSame) {
  const Terrain& t = reference::built_terrain(GetParam());
  const StoreFacts& f = t.store().facts();
  std::mt19937_64 random(7);
  const auto place = [&] {
    const auto at = [&](std::int32_t low, std::int32_t high, std::uint64_t kind) {
      const double v = std::uniform_real_distribution<double>(low, high)(random);
      return kind == 0 ? v : (kind == 1 ? std::round(v) : std::round(2 * v) / 2);
    };
    const std::uint64_t kind = random() % 3;
    const double x = at(f.bounds.min_x, f.bounds.max_x, kind);
    return f.map.to_map(x, at(f.bounds.min_y, f.bounds.max_y, kind));
  };
  std::array<int, 4> verdicts{};
  for (const bool verdict_only : {true, false}) {
    SightRequest request;
    request.verdict_only = verdict_only;
    SightSolver stars(t, request, 300);
    SightSolver splits = t.sight_lines(request, 0, AnswerBy::kSplits);
    for (const std::uint64_t i : test::some_of_first(400)) {
      const double height = static_cast<double>(random() % 5 * (random() % 3) * 20);
      const SightPair pair{place(), height, place(), height};
      const SightResult a = stars.solve(pair);
      const SightResult b = splits.solve(pair);
      ++verdicts[static_cast<std::size_t>(a.verdict)];
      ASSERT_EQ(a.verdict, b.verdict) << i;
      ASSERT_EQ(a.exact, b.exact) << i;
      ASSERT_TRUE(is_same(a.clearance_min, b.clearance_min)) << i;
      ASSERT_TRUE(is_same(a.clearance_max, b.clearance_max)) << i;
      ASSERT_TRUE(is_same(a.void_length, b.void_length)) << i;
      ASSERT_TRUE(verdict_only || is_same(a.obstruction, b.obstruction)) << i;
    }
  }
  EXPECT_GT(verdicts[static_cast<std::size_t>(SightVerdict::kVisible)], 50);
  EXPECT_GT(verdicts[static_cast<std::size_t>(SightVerdict::kHidden)], 50);
}

/// What answers at levels are worth: how wide intervals are, and how many answers are open.
struct SightWorth {
  double width = 0.0;
  int finite = 0, undecided = 0;

  void add(const SightResult& found, const SightResult& exact) {
    if (found.verdict == SightVerdict::kUndecided) {
      ++undecided;
    } else {
      ASSERT_EQ(found.verdict, exact.verdict);
    }
    if (std::isnan(found.clearance_min)) return;
    ASSERT_LE(found.clearance_min, exact.clearance_min + 1e-9);
    ASSERT_GE(found.clearance_max, exact.clearance_max - 1e-9);
    if (std::isfinite(found.clearance_max)) {
      width += found.clearance_max - found.clearance_min;
      ++finite;
    }
  }
};

/// Stars tell more of a line at a level than splits do, and nothing that is wrong.
TEST_P(SightByBothWays, AtALevelStarsTellMore) {
  const Terrain& t = reference::built_terrain(GetParam());
  const StoreFacts& f = t.store().facts();
  SightSolver full(t, {}, 0);
  for (const std::uint64_t vertices : test::some_of<std::uint64_t>({600, 3000, 9001})) {
    SightRequest request;
    request.detail.vertices = vertices;
    SightSolver by_stars(t, request, 0);
    SightSolver by_splits = t.sight_lines(request, 0, AnswerBy::kSplits);
    std::mt19937_64 random(vertices);
    SightWorth stars;
    SightWorth splits;
    for (int i = 0; i < 150; ++i) {
      const auto place = [&] {
        const auto at = [&](std::int32_t low, std::int32_t high) {
          const double v = std::uniform_real_distribution<double>(low, high)(random);
          return i % 2 == 0 ? v : std::round(v);
        };
        const double x = at(f.bounds.min_x, f.bounds.max_x);
        return f.map.to_map(x, at(f.bounds.min_y, f.bounds.max_y));
      };
      const MapPoint a = place();
      const SightPair pair{a, static_cast<double>(i % 4 * 20), place(), 30.0};
      const SightResult exact = full.solve(pair);
      stars.add(by_stars.solve(pair), exact);
      splits.add(by_splits.solve(pair), exact);
      if (HasFatalFailure()) return;
    }
    EXPECT_LE(stars.undecided, splits.undecided) << vertices;
    EXPECT_GE(stars.finite, splits.finite) << vertices;
    // Where there are voids splits have no bound for most lines that have wide ones.
    const double most = f.free_of_voids ? 1.0 : 3.0;
    EXPECT_LE(stars.width / stars.finite, most * splits.width / splits.finite) << vertices;
  }
}

INSTANTIATE_TEST_SUITE_P(Terrains, SightByBothWays,
                         ::testing::Values("mountains_257.tif", "coast_257.tif"),
                         [](const auto& of) {
                           const std::string name = of.param;
                           return name.substr(0, name.find('_'));
                         });

}  // namespace
}  // namespace ptin
