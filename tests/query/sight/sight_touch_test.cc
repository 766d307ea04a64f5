// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of sight along edges and through vertices, at any level of detail, by stars and by splits,
// against every triangle of the full TIN in rationals.
#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/query/sight/sight.h"
#include "tests/query/sight/sight_oracle.h"

namespace ptin {
namespace {

using reference::least_clearance_near;
using reference::Rational;
using reference::SmallTerrain;
using reference::true_sight;
using reference::TrueSight;

struct TouchCase {
  SightRequest request;
  SightPair pair;
  Spot p, q;
  double bend = 0.0;
};

/// Heights that make a line pass vertices at their very height.
double whole_height(std::mt19937_64& random, bool absolute) {
  if (random() % 6 == 0) {
    return std::uniform_real_distribution<double>(absolute ? -2 : -1, absolute ? 14 : 4)(random);
  }
  return static_cast<double>(random() % (absolute ? 13 : 3));
}

TouchCase touch_case(std::mt19937_64& random, const SmallTerrain& t) {
  TouchCase asked;
  const StoreFacts& f = t.terrain->store().facts();
  const SpotMap map(f.map, f.bounds);
  do {
    const auto [p, q] = reference::nasty_line(random, t.full);
    asked.pair.a = map.map(p);
    asked.pair.b = map.map(q);
    asked.p = *map.spot(asked.pair.a);
    asked.q = *map.spot(asked.pair.b);
  } while (asked.p == asked.q);
  asked.request.absolute = random() % 2 == 0;
  asked.request.curvature.coefficient = random() % 4 == 0 ? 0.85714 : 0.0;
  asked.request.curvature.earth_diameter = 60.0;
  asked.pair.height_a = whole_height(random, asked.request.absolute);
  asked.pair.height_b = whole_height(random, asked.request.absolute);
  const double dx = asked.pair.b.x - asked.pair.a.x;
  const double dy = asked.pair.b.y - asked.pair.a.y;
  asked.bend = asked.request.curvature.drop_at(std::sqrt(dx * dx + dy * dy));
  return asked;
}

TrueSight truth_of(const SmallTerrain& t, const TouchCase& asked) {
  return true_sight(t, asked.p, asked.pair.height_a, asked.q, asked.pair.height_b,
                    asked.request.absolute, asked.bend);
}

/// One of the levels of detail; now and then with a budget, or for the verdict alone.
void choose_how(std::mt19937_64& random, const StoreFile& store, SightRequest& request) {
  switch (random() % 3) {
    case 0:
      break;
    case 1:
      request.detail.tolerance = static_cast<double>(random() % 9) / 2;
      break;
    default:
      request.detail.vertices = store.t0().vertices.size() + random() % (store.record_count() + 2);
  }
  request.verdict_only = random() % 2 == 0;
  request.wavelength = random() % 4 == 0 ? 1.0 : 0.0;
  if (random() % 6 == 0) {
    request.budget = random() % 60;
  }
}

/// Whatever an answer tells is true.
void check_true(const SmallTerrain& t, const TouchCase& asked, const TrueSight& truth,
                const SightResult& found) {
  if (found.verdict == SightVerdict::kUndecided) {
    RC_ASSERT(!found.exact);
  } else {
    RC_ASSERT(truth.defined == (found.verdict != SightVerdict::kUndefined));
  }
  if (!truth.defined) {
    return;
  }
  if (found.verdict != SightVerdict::kUndecided) {
    RC_ASSERT(found.verdict == (truth.hidden ? SightVerdict::kHidden : SightVerdict::kVisible));
  }
  RC_ASSERT(found.obstruction.has_value() == (found.verdict == SightVerdict::kHidden));
  if (found.obstruction) {
    const std::optional<Rational> clearance =
        least_clearance_near(t, asked.p, asked.pair.height_a, asked.q, asked.pair.height_b,
                             asked.request.absolute, asked.bend, found.obstruction->share);
    RC_ASSERT(clearance.has_value());
    RC_ASSERT(clearance->convert_to<double>() < 1e-6);
  }
  if (truth.clearance && !std::isnan(found.clearance_min)) {
    RC_ASSERT(found.clearance_min <= truth.clearance->convert_to<double>() + 1e-9);
    RC_ASSERT(found.clearance_max >= truth.clearance->convert_to<double>() - 1e-9);
  }
  if (!std::isnan(found.void_length)) {
    RC_ASSERT(asked.request.verdict_only ||
              std::abs(found.void_length - truth.void_share * found.length) < 1e-6);
  }
}

/// What is called exact is the truth, all of it.
void check_exact(const TouchCase& asked, const TrueSight& truth, const SightResult& found) {
  RC_ASSERT(found.state_a == truth.state_p);
  RC_ASSERT(found.state_b == truth.state_q);
  RC_ASSERT(found.verdict != SightVerdict::kUndecided);
  if (asked.request.verdict_only || !truth.defined) {
    return;
  }
  RC_ASSERT(std::isnan(found.clearance_min) == !truth.clearance.has_value());
  if (truth.clearance) {
    RC_ASSERT(found.clearance_min == found.clearance_max);
  }
  if (truth.hidden) {
    RC_ASSERT(std::abs(found.obstruction->share - truth.first) < 1e-6);
  }
  RC_ASSERT(std::abs(found.void_length - truth.void_share * found.length) < 1e-6);
}

/// Asks by stars, by splits, and a solver that has a coarse level.
void check_all_ways(std::mt19937_64& random, const SmallTerrain& t, const Terrain& asked_of,
                    TouchCase asked) {
  const TrueSight truth = truth_of(t, asked);
  const bool is_asked = asked.request.detail.tolerance || asked.request.detail.vertices;
  const bool is_rough = asked_of.store().facts().base_deviation > 0;
  const auto check = [&](AnswerBy by, std::uint64_t coarse_records) {
    const SightResult found =
        asked_of.sight_lines(asked.request, coarse_records, by).solve(asked.pair);
    check_true(t, asked, truth, found);
    RC_ASSERT(found.exact || is_asked || is_rough || asked.request.budget);
    if (found.exact) {
      check_exact(asked, truth, found);
    }
  };
  check(AnswerBy::kBest, 0);
  check(AnswerBy::kStars, 0);
  check(AnswerBy::kSplits, 0);
  if (asked.request.verdict_only) {
    check(AnswerBy::kStars, 1 + random() % 100);
  }
}

RC_GTEST_PROP(SightTouch, IsTrueAtEveryLevelByStarsAndBySplits, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain t(seed);
  for (int i = 0; i < 10; ++i) {
    TouchCase asked = touch_case(random, t);
    choose_how(random, t.terrain->store(), asked.request);
    check_all_ways(random, t, *t.terrain, asked);
  }
}

/// An upright line of absolute heights, of which the lower one is the rounded height of the ground.
RC_GTEST_PROP(SightTouch, StandsOnTheGroundUpright, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain t(seed);
  const StoreFacts& facts = t.terrain->store().facts();
  const SpotMap map(facts.map, facts.bounds);
  for (int i = 0; i < 20; ++i) {
    SightPair pair;
    pair.a = pair.b = map.map(reference::nasty_spot(random, t.full));
    const Spot at = *map.spot(pair.a);
    const auto depth = least_clearance_near(t, at, 0.0, at, 0.0, true, 0.0, 0.0);
    if (!depth) {
      continue;
    }
    pair.height_a = -depth->convert_to<double>();
    pair.height_b = pair.height_a + static_cast<double>(random() % 2);
    SightRequest request;
    request.absolute = true;
    const AnswerBy by = random() % 2 == 0 ? AnswerBy::kStars : AnswerBy::kSplits;
    const bool is_below = Rational(pair.height_a) + *depth < 0;
    RC_ASSERT(t.terrain->sight(pair, request, by).verdict ==
              (is_below ? SightVerdict::kHidden : SightVerdict::kVisible));
  }
}

/// Files that left detail out: without voids, since classes are those of the file's finest TIN; with
/// an error of 0 left out a file has the source's voids.
RC_GTEST_PROP(SightTouch, IsTrueOfAFileThatIsNotExact, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const SmallTerrain t(seed);
  const SmallTerrain rough(seed, static_cast<double>(1 + random() % 6) / 4);
  const StoreFacts& facts = rough.terrain->store().facts();
  RC_PRE(facts.free_of_voids || facts.base_error == 0);
  for (int i = 0; i < 10; ++i) {
    TouchCase asked = touch_case(random, t);
    choose_how(random, rough.terrain->store(), asked.request);
    check_all_ways(random, t, *rough.terrain, asked);
  }
}

}  // namespace
}  // namespace ptin
