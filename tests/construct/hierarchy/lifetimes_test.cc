// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every triangle that a terrain ever has stands in a star or in T0, with the error at which it dies
// (engine/DESIGN.md, section 2.10): over all kinds of sources, tiles of several levels, any number of
// threads, interrupted or not, and with fine detail left out.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/delaunay/point_tile.h"
#include "engine/construct/raster/raster_tile.h"
#include "engine/construct/stored_detail.h"
#include "engine/construct/tile_tasks/build_hierarchy.h"
#include "engine/construct/tin/tin_source.h"
#include "engine/construct/tin/tin_tile.h"
#include "engine/error.h"
#include "tests/construct/hierarchy_fixture.h"
#include "tests/construct/lifetime_oracle.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/point_sets.h"
#include "tests/construct/surface_oracle.h"
#include "tests/construct/test_terrain.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::BuiltStars;

/// A source as build_hierarchy() wants it. Starters borrow what made them.
struct Source {
  TileTree tree;
  MeasureUnits units;
  std::function<LeafStarter()> make_starter;
};

HierarchyOptions options_of(const Source& source, int threads) {
  HierarchyOptions options;
  options.collapse.units = source.units;
  options.threads = threads;
  options.checkpoint_interval = std::chrono::milliseconds(0);
  return options;
}

BuiltStars taken(BuiltHierarchy&& built, const test::RecordsInMemory& output) {
  return {std::move(built.t0), std::move(built.t0_deaths), output.starred()};
}

BuiltStars build_stars(const Source& source, int threads = 1, double first_pass = 0.0) {
  const oracle::ScratchFolder folder;
  test::UnsyncedFiles files;
  Workspace workspace(files, folder.file("t.ptin"), "", Unfinished::kRefuse, {});
  test::RecordsInMemory output;
  HierarchyOptions options = options_of(source, threads);
  options.collapse.first_pass = first_pass;
  return taken(build_hierarchy(source.make_starter, source.tree, options, workspace, output),
               output);
}

std::string check(const BuiltStars& built) {
  const std::string fault = oracle::check_stars(built);
  return fault.empty() ? oracle::check_intervals(built, 7) : fault;
}

void expect_same(const BuiltStars& a, const BuiltStars& b) {
  EXPECT_TRUE(a.records.splits == b.records.splits);
  EXPECT_TRUE(a.records.corners == b.records.corners);
  EXPECT_TRUE(a.records.ring_end == b.records.ring_end);
  EXPECT_TRUE(oracle::named_triangles(a.t0) == oracle::named_triangles(b.t0));
  EXPECT_TRUE(a.t0_deaths == b.t0_deaths);
}

/// Triangles die in stars and in T0, or the test would show little.
void expect_deaths(const BuiltStars& built) {
  EXPECT_TRUE(std::any_of(built.records.corners.begin(), built.records.corners.end(),
                          [](const RingCorner& c) { return c.death > 0.0F; }));
  EXPECT_TRUE(std::any_of(built.t0_deaths.begin(), built.t0_deaths.end(),
                          [](float death) { return death > 0.0F; }));
}

// -------------------------------------------------------------------------------------------------
// Rasters.

/// Hills with noise, and a mask of blobs when `voids`.
class Hills {
 public:
  Hills(int size, unsigned seed, bool voids) : size_(size), seed_(seed), voids_(voids) {}

  [[nodiscard]] Source tiled(std::int64_t side) const {
    Source source{TileTree(size_, size_, side), {}, {}};
    source.units.heights = oracle::kInt;
    source.units.void_slope_code = 0.1;
    source.units.exact_codes = true;
    source.make_starter = [this, units = source.units]() -> LeafStarter {
      return [this, units](const SampleRange& window) { return start(window, units); };
    };
    return source;
  }

 private:
  [[nodiscard]] int height(std::int64_t x, std::int64_t y) const {
    const auto h = static_cast<unsigned>(x) * 73856093U ^ static_cast<unsigned>(y) * 19349663U;
    return static_cast<int>(400.0 * std::sin(0.05 * double(x) + seed_) *
                                std::cos(0.04 * double(y)) +
                            60.0 * std::sin(0.3 * double(x) + 0.2 * double(y))) +
           static_cast<int>((h ^ seed_) % 12);
  }
  [[nodiscard]] bool is_valid(std::int64_t x, std::int64_t y) const {
    return !voids_ || std::sin(0.2 * double(x)) + std::cos(0.17 * double(y)) < 0.9;
  }
  [[nodiscard]] StartedTile start(const SampleRange& window, const MeasureUnits& units) const {
    RasterSamples samples;
    samples.raster = {0, 0, size_, size_};
    samples.range = range_around(samples.raster, window);
    samples.has_voids = voids_;
    const SampleRange& r = samples.range;
    for (std::int64_t y = r.y0; y < r.y0 + r.height; ++y) {
      for (std::int64_t x = r.x0; x < r.x0 + r.width; ++x) {
        samples.valid.push_back(is_valid(x, y) ? 1 : 0);
        samples.heights.push_back(is_valid(x, y) ? units.heights.bits(height(x, y)) : 0);
      }
    }
    return start_raster_tile(std::move(samples), window, units);
  }

  int size_;
  unsigned seed_;
  bool voids_;
};

TEST(Lifetimes, AreThoseOfTheSplitsOverRasters) {
  for (const bool voids : test::some_of({false, true})) {
    const Hills hills(65, voids ? 2U : 1U, voids);
    for (const std::int64_t side :
         test::some_of<std::int64_t>({8, 20, 1000})) {  // levels 0 to 3, 0 to 2, and 0 alone
      SCOPED_TRACE(std::to_string(side) + (voids ? ", voids" : ""));
      const BuiltStars built = build_stars(hills.tiled(side));
      expect_deaths(built);
      EXPECT_EQ(check(built), "");
    }
  }
}

TEST(Lifetimes, AreThoseOfTheSplitsWhereTheRootIsOfLevelOne) {
  const BuiltStars built = build_stars(Hills(33, 3, true).tiled(16));
  EXPECT_EQ(check(built), "");
}

TEST(Lifetimes, DoNotDependOnThreads) {
  const Hills hills(65, 4, true);
  const Source source = hills.tiled(8);
  const BuiltStars alone = build_stars(source);
  for (const int threads : test::some_of({2, 5})) {
    expect_same(alone, build_stars(source, threads));
  }
}

/// A build that is stopped again and again, after `leaves` further leaves of either stage.
BuiltStars build_in_steps(const Source& source, std::uint64_t leaves, int threads) {
  const oracle::ScratchFolder folder;
  test::UnsyncedFiles files;
  test::RecordsInMemory output;
  int stops = 0;
  for (;;) {
    Workspace workspace(files, folder.file("t.ptin"), "", Unfinished::kResume, {});
    std::stop_source stop;
    std::uint64_t left = leaves;
    HierarchyOptions options = options_of(source, threads);
    options.stop = stop.get_token();
    options.progress = [&](const StageProgress&) {
      if (--left == 0) {
        stop.request_stop();
      }
    };
    try {
      BuiltHierarchy built =
          build_hierarchy(source.make_starter, source.tree, options, workspace, output);
      EXPECT_GT(stops, 4);
      return taken(std::move(built), output);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
      ++stops;
    }
  }
}

TEST(Lifetimes, DoNotDependOnInterruptions) {
  const Hills hills(65, 4, true);
  const Source source = hills.tiled(8);
  for (const int threads : test::some_of({1, 3})) {
    expect_same(build_stars(source), build_in_steps(source, 13, threads));
  }
}

TEST(Lifetimes, EndWithWhatTheFileLeavesOut) {
  for (const bool voids : test::some_of({false, true})) {
    const Hills hills(65, 5, voids);
    for (const StoredDetail detail :
         test::some_of<StoredDetail>({{0.25, 0.0}, {0.0, 20.0}, {0.25, 20.0}}, 3)) {
      for (const double share : test::some_of({0.0, 0.7})) {
        const double first_pass = share * detail.max_error;
        SCOPED_TRACE(std::to_string(detail.max_error) + ", first pass " +
                     std::to_string(first_pass) + (voids ? ", voids" : ""));
        BuiltStars built = build_stars(hills.tiled(8), 1, first_pass);
        const std::size_t all = built.records.size();
        detail.add_rounding(built.records);
        const RecordBounds worst = detail.leave_out(built.records);
        std::transform(built.t0_deaths.begin(), built.t0_deaths.end(), built.t0_deaths.begin(),
                       [&](float death) { return detail.death(death); });
        EXPECT_EQ(built.records.size() < all, detail.max_error > 0.0);
        EXPECT_LE(static_cast<double>(worst.error), detail.max_error);
        EXPECT_GT(built.records.size(), 20U);
        EXPECT_EQ(check(built), "");
      }
    }
  }
}

// -------------------------------------------------------------------------------------------------
// Points and TINs.

TEST(Lifetimes, AreThoseOfTheSplitsOverPoints) {
  for (const PointKind kind : test::some_of(kPointKinds)) {
    for (const std::optional<double> max_edge :
         test::some_of<std::optional<double>>({std::nullopt, 400.0})) {
      SCOPED_TRACE(name_of(kind) + (max_edge ? ", voids" : ""));
      const PointBuckets points = buckets_of(kind, 900, 3);
      Source source{TileTree::over_points(points.size(), 5,
                                          std::make_shared<const ConvexHull>(points.hull())),
                    measure_units(points.frame(), 0.1),
                    {}};
      source.make_starter = [&]() -> LeafStarter {
        const auto starter =
            std::make_shared<PointTileStarter>(points, source.tree, source.units, max_edge);
        return [starter](const SampleRange& window) { return starter->start(window); };
      };
      const BuiltStars built = build_stars(source);
      EXPECT_EQ(check(built), "");
      expect_same(built, build_stars(source, 2));
    }
  }
}

/// A square of `side` x `side` cells as OBJ, each two triangles, with holes.
std::string obj_with_holes(int side) {
  std::string text;
  for (int y = 0; y <= side; ++y) {
    for (int x = 0; x <= side; ++x) {
      const int z = static_cast<int>(50.0 * std::sin(0.3 * x) * std::cos(0.2 * y)) + x * y % 7;
      text += "v " + std::to_string(10 * x) + " " + std::to_string(10 * y) + " " +
              std::to_string(z) + "\n";
    }
  }
  const auto put = [&](const std::array<int, 3>& f) {
    text += "f";
    for (const int v : f) {
      text += " " + std::to_string(v + 1);
    }
    text += "\n";
  };
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const int v = y * (side + 1) + x;
      if (x % 9 > 1 || y % 7 > 1 || x == 0) {
        put({v, v + 1, v + side + 2});
        put({v, v + side + 2, v + side + 1});
      }
    }
  }
  return text;
}

TEST(Lifetimes, AreThoseOfTheSplitsOverATinWithHoles) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("in.obj"), obj_with_holes(30));
  const TinTriangles triangles =
      TinTriangles::read(folder.file("in.obj"), {}, {FileLayer::system(), folder.file("")});
  Source source{TileTree::over_points(triangles.counts().vertices, 5,
                                      std::make_shared<const ConvexHull>(triangles.hull())),
                measure_units(triangles.frame(), 0.1),
                {}};
  source.make_starter = [&]() -> LeafStarter {
    return [&](const SampleRange& window) {
      return start_tin_tile(triangles, source.tree, window, source.units);
    };
  };
  const BuiltStars built = build_stars(source);
  expect_deaths(built);
  EXPECT_EQ(check(built), "");
  expect_same(built, build_stars(source, 2));
}

// -------------------------------------------------------------------------------------------------
// One tile.

TEST(Lifetimes, AreThoseOfTheSplitsOverNastyTerrains) {
  auto makes = oracle::nasty_rasters();
  const auto points = oracle::nasty_points();
  makes.insert(makes.end(), points.begin(), points.end());
  for (const auto& make : makes) {
    oracle::TestTerrain terrain = oracle::simplified(make());
    SCOPED_TRACE(terrain.name);
    BuiltStars built;
    built.t0 = terrain.tile.tin;
    built.t0_deaths = deaths_of(terrain.tile);
    built.records =
        starred_records(std::move(terrain.tile.records), 0, std::move(terrain.tile.stars));
    EXPECT_EQ(check(built), "");
  }
}

}  // namespace
}  // namespace ptin
