// SPDX-License-Identifier: GPL-3.0-or-later
//
// What DESIGN.md, section 2, promises of refinements in memory: P1, P2, P3 and P5.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/mesh/validate.h"
#include "tests/construct/surface_oracle.h"
#include "tests/construct/test_terrain.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::TestTerrain;

/// Errors of records at even places of their order, each also a step below; and 0.
std::vector<double> tolerances(const std::vector<VertexSplit>& records, std::size_t count) {
  std::vector<float> errors;
  for (const VertexSplit& r : records) {
    if (std::isfinite(r.error)) {
      errors.push_back(r.error);
    }
  }
  std::sort(errors.begin(), errors.end());
  std::vector<double> all{0.0, std::numeric_limits<double>::max()};
  for (std::size_t i = 0; i < count && !errors.empty(); ++i) {
    const float e = errors[i * (errors.size() - 1) / std::max<std::size_t>(count - 1, 1)];
    all.push_back(e);
    all.push_back(std::nextafter(e, 0.0F));
  }
  return all;
}

/// Refines to each tolerance and checks the result at every sample and crossing.
std::string check_tolerances(const TestTerrain& terrain, std::size_t count) {
  for (const double tolerance : tolerances(terrain.tile.records, count)) {
    std::string fault;
    double deviation = 0.0;
    const auto needed = [&](const VertexSplit& r) {
      const bool is = static_cast<double>(r.error) > tolerance;
      deviation = is ? deviation : std::max(deviation, static_cast<double>(r.deviation));
      return is;
    };
    const Tin tin = oracle::refined(terrain.tile.tin, terrain.tile.records, needed, fault);
    for (const auto& check :
         {std::function<std::string()>([&] { return validate(tin); }),
          {[&] { return oracle::check_samples(terrain, tin, tolerance); }},
          {[&] { return oracle::check_deviation(terrain, tin, deviation); }},
          {[&] { return oracle::check_random_points(terrain, tin, deviation, 20, 1); }}}) {
      fault = fault.empty() ? check() : fault;
    }
    if (!fault.empty()) {
      return terrain.name + ", tolerance " + std::to_string(tolerance) + ": " + fault;
    }
  }
  return {};
}

/// Any monotone predicate: boxes that are met, levels, tolerances, views, and both of two.
oracle::RecordPredicate random_predicate(std::mt19937_64& random, const TestTerrain& terrain,
                                         int depth = 0) {
  const auto& records = terrain.tile.records;
  const VertexSplit& some = records[random() % records.size()];
  const HeightEncoding heights = terrain.tile.units.heights;
  switch (random() % (depth < 3 ? 6 : 4)) {
    case 0: {
      const GridBox box = united(box_of(some.u), records[random() % records.size()].w);
      return [=](const VertexSplit& r) { return meets(r.roi, box); };
    }
    case 1: {
      const double level = heights.code(some.height_lo);
      return [=](const VertexSplit& r) {
        return heights.code(r.height_lo) <= level && level <= heights.code(r.height_hi);
      };
    }
    case 2:
      return [e = some.error](const VertexSplit& r) { return r.error > e; };
    case 3:
      return [u = some.u, e = some.error](const VertexSplit& r) {
        const double dx = std::max(
            {0.0, static_cast<double>(r.roi.min_x) - u.x, static_cast<double>(u.x) - r.roi.max_x});
        const double dy = std::max(
            {0.0, static_cast<double>(r.roi.min_y) - u.y, static_cast<double>(u.y) - r.roi.max_y});
        return static_cast<double>(r.error) > 0.1 * static_cast<double>(e) * std::max(dx, dy);
      };
    default: {
      const auto a = random_predicate(random, terrain, depth + 1);
      const auto b = random_predicate(random, terrain, depth + 1);
      const bool both = random() % 2 == 0;
      return [=](const VertexSplit& r) { return both ? a(r) && b(r) : a(r) || b(r); };
    }
  }
}

TEST(Promises, EverySampleIsWithinTheToleranceOnNastyRasters) {
  for (const auto& make : test::some_of(oracle::nasty_rasters(), 2, 1)) {
    EXPECT_EQ(check_tolerances(oracle::simplified(make()), 4), "");
  }
}

TEST(Promises, EverySampleIsWithinTheToleranceOnNastyPoints) {
  for (const auto& make : oracle::nasty_points()) {
    EXPECT_EQ(check_tolerances(oracle::simplified(make()), 4), "");
  }
}

RC_GTEST_PROP(Promises, EverySampleIsWithinTheToleranceOnRandomTerrains, (std::uint64_t seed)) {
  RC_ASSERT(check_tolerances(oracle::simplified(oracle::random_terrain(seed, 80)), 3) == "");
}

TEST(Promises, AllRecordsGiveBackTheFullTin) {
  auto makes = oracle::nasty_rasters();
  const auto points = oracle::nasty_points();
  makes.insert(makes.end(), points.begin(), points.end());
  for (const auto& make : makes) {
    const TestTerrain terrain = oracle::simplified(make());
    std::string fault;
    const auto all = [](const VertexSplit&) { return true; };
    const Tin tin = oracle::refined(terrain.tile.tin, terrain.tile.records, all, fault);
    EXPECT_EQ(fault, "") << terrain.name;
    EXPECT_EQ(validate(tin), "") << terrain.name;
    EXPECT_TRUE(oracle::named_triangles(tin) == oracle::named_triangles(terrain.full))
        << terrain.name;
  }
}

RC_GTEST_PROP(Promises, MonotonePredicatesGiveValidTinsInAnyOrderOfOneRank, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const TestTerrain terrain =
      oracle::simplified(oracle::random_terrain(seed, 150), static_cast<CostModel>(seed % 3));
  RC_PRE(!terrain.tile.records.empty());
  for (int i = 0; i < 5; ++i) {
    const auto predicate = random_predicate(random, terrain);
    std::string fault;
    const Tin tin = oracle::refined(terrain.tile.tin, terrain.tile.records, predicate, fault);
    RC_ASSERT(fault == "");
    RC_ASSERT(validate(tin) == "");
    const Tin again =
        oracle::refined(terrain.tile.tin, terrain.tile.records, predicate, fault, &random);
    RC_ASSERT(fault == "");
    RC_ASSERT(oracle::named_triangles(tin) == oracle::named_triangles(again));
  }
}

/// Triangles that meet a box, by their bounding boxes' corners and the exact sides.
std::vector<oracle::NamedTriangle> meeting(const Tin& tin, const GridBox& box) {
  std::vector<oracle::NamedTriangle> all = oracle::named_triangles(tin);
  std::erase_if(all, [&](const oracle::NamedTriangle& t) {
    const GridPoint c[3] = {point_of(std::get<0>(t)), point_of(std::get<1>(t)),
                            point_of(std::get<2>(t))};
    const GridPoint corners[4] = {{box.min_x, box.min_y},
                                  {box.max_x, box.min_y},
                                  {box.max_x, box.max_y},
                                  {box.min_x, box.max_y}};
    if (!meets(box, united(united(box_of(c[0]), c[1]), c[2]))) {
      return true;
    }
    for (int i = 0; i < 3; ++i) {
      if (std::all_of(corners, corners + 4,
                      [&](GridPoint p) { return oracle::side(c[i], c[(i + 1) % 3], p) < 0; })) {
        return true;
      }
    }
    return false;
  });
  return all;
}

RC_GTEST_PROP(Promises, AWindowIsExactAndJoinsItsNeighbour, (std::uint64_t seed)) {
  const TestTerrain terrain = oracle::simplified(oracle::random_terrain(seed, 150));
  RC_PRE(!terrain.tile.records.empty());
  std::mt19937_64 random(seed);
  const auto& records = terrain.tile.records;
  const auto some = [&] { return records[random() % records.size()].u; };
  const GridBox first = united(box_of(some()), some());
  const GridBox second = united(box_of(some()), some());
  const float tolerance = random() % 2 == 0 ? -1.0F : records[random() % records.size()].error;
  std::string fault;
  const auto refine = [&](const GridBox& box) {
    return oracle::refined(
        terrain.tile.tin, records,
        [&](const VertexSplit& r) { return r.error > tolerance && meets(r.roi, box); }, fault);
  };
  const Tin a = refine(first);
  const Tin b = refine(second);
  RC_ASSERT(fault == "");
  if (tolerance < 0.0F) {
    RC_ASSERT(meeting(a, first) == meeting(terrain.full, first));
  }
  // What meets both boxes is the same in both.
  const auto both = [&](const Tin& tin) {
    const auto in_first = meeting(tin, first);
    const auto in_second = meeting(tin, second);
    std::vector<oracle::NamedTriangle> common;
    std::set_intersection(in_first.begin(), in_first.end(), in_second.begin(), in_second.end(),
                          std::back_inserter(common));
    return common;
  };
  RC_ASSERT(both(a) == both(b));
}

}  // namespace
}  // namespace ptin
