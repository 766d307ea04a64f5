// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of sight against the full TIN in rationals.
#include "engine/query/sight/sight.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "tests/query/built_terrain.h"
#include "tests/query/sight/sight_oracle.h"

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
  if (!truth.defined) {
    RC_ASSERT(found.verdict == SightVerdict::kUndefined);
    return;
  }
  RC_ASSERT(found.verdict == (truth.hidden ? SightVerdict::kHidden : SightVerdict::kVisible));
  RC_ASSERT(found.exact);
}

void check_measures(const TrueSight& truth, const SightResult& found) {
  RC_ASSERT(found.state_a == truth.state_p);
  RC_ASSERT(found.state_b == truth.state_q);
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
    const SightResult found = sight(*t.terrain, asked.pair, asked.request);
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
    const SightResult found = sight(*t.terrain, asked.pair, asked.request);
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
  const SightResult exact = sight(*t.terrain, asked.pair, asked.request);
  asked.request.detail.vertices = std::uint64_t{1} << 40;
  const SightResult all = sight(*t.terrain, asked.pair, asked.request);
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
    check_certificate(truth, sight(*rough.terrain, asked.pair, asked.request));
  }
}

}  // namespace
}  // namespace ptin
