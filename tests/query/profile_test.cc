// SPDX-License-Identifier: GPL-3.0-or-later
//
// Profiles against every triangle of the full TIN, and against point location.
#include "engine/query/profile.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "tests/query/line_oracle.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::nasty_spot;
using reference::rational_of;

RC_GTEST_PROP(Profile, BreaksWhereTheFullTinDoesAtItsHeights, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Hierarchy h = reference::random_hierarchy(seed);
  const reference::TemporaryStore file(h);
  const ProgressiveTin terrain(file.open());
  const SpotMap map(h.facts.map, h.facts.bounds);
  for (int i = 0; i < 3; ++i) {
    const Spot p = nasty_spot(random, h.full);
    const Spot q = nasty_spot(random, h.full);
    if (p == q) {
      continue;
    }
    const MapPoint line[] = {map.map(p), map.map(q)};
    const ProfileResult found = profile(terrain, line);
    RC_ASSERT(found.exact);
    auto wanted = reference::stops(h.full, rational_of(p), rational_of(q));
    wanted.insert(0);  // the ends of the line, wherever they are
    wanted.insert(1);
    RC_ASSERT(found.points.size() == wanted.size());
    const double length = found.points.back().distance;
    std::size_t k = 0;
    for (const reference::Rational& share : wanted) {
      const ProfilePoint& point = found.points[k++];
      RC_ASSERT(std::abs(point.distance - length * share.convert_to<double>()) < 1e-9 * length);
      const auto at = reference::along(rational_of(p), rational_of(q), share);
      for (const TriangleId t : reference::triangles_at(h.full, at)) {
        if (!std::isnan(point.height) && h.full.classes[t] == TriangleClass::kSurface) {
          const double exact = h.facts.heights.height_of_code(
              reference::code_on(h.full, h.facts.heights, t, at).convert_to<double>());
          RC_ASSERT(std::abs(point.height - exact) < 1e-9);
        }
      }
    }
  }
}

TEST(Profile, FollowsALineOfSeveralSegments) {
  const Hierarchy h = reference::random_hierarchy(11);
  const reference::TemporaryStore file(h);
  const ProgressiveTin terrain(file.open());
  const GridBox& b = h.facts.bounds;
  const MapPoint line[] = {
      h.facts.map.to_map(b.min_x, b.min_y), h.facts.map.to_map(b.max_x, b.min_y),
      h.facts.map.to_map(b.max_x, b.min_y), h.facts.map.to_map(b.max_x, b.max_y)};
  const ProfileResult found = profile(terrain, line);
  EXPECT_DOUBLE_EQ(found.points.back().distance,
                   0.5 * (b.max_x - b.min_x) + 0.5 * (b.max_y - b.min_y));
  for (std::size_t i = 1; i < found.points.size(); ++i) {
    EXPECT_LT(found.points[i - 1].distance, found.points[i].distance);
  }
  EXPECT_EQ(found.points.back().part, 1u);
}

TEST(Profile, RejectsWhatIsNoLine) {
  const Hierarchy h = reference::random_hierarchy(12);
  const reference::TemporaryStore file(h);
  const ProgressiveTin terrain(file.open());
  const MapPoint one[] = {{1000, -500}, {1000, -500}};
  const MapPoint bad[] = {{1000, -500}, {std::nan(""), 0}};
  EXPECT_THROW(static_cast<void>(profile(terrain, one)), Error);
  EXPECT_THROW(static_cast<void>(profile(terrain, bad)), Error);
}

}  // namespace
}  // namespace ptin
