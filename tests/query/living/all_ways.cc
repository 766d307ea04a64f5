// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/query/living/all_ways.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/mesh/link.h"
#include "storage/floor.h"
#include "tests/query/far_file.h"
#include "tests/query/isoline/isoline_listing.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin::reference {

namespace {

bool are_same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool are_same(const LocatedPoint& a, const LocatedPoint& b) {
  bool same = a.state == b.state && are_same(a.height, b.height) &&
              are_same(a.height_min, b.height_min) && are_same(a.height_max, b.height_max);
  for (std::size_t i = 0; i < 3; ++i) {
    same = same && a.triangle[i].position == b.triangle[i].position &&
           are_same(a.triangle[i].height, b.triangle[i].height);
  }
  return same;
}

/// A terrain, and the same answered from stars.
class Ways {
 public:
  Ways(const Terrain& terrain, const AllWays& asked, std::uint64_t seed)
      : heights_(terrain), stars_(terrain), asked_(asked), random_(seed) {
    stars_.use_floor(false);
    points_ = places_of_raster(facts(), std::int64_t{1} << terrain.floor()->facts().shape.side_log2,
                               asked.points, random_);
  }

  void expect_same_points() {
    const LocateResult all = heights_.locate(points_, {}, AnswerBy::kHeights);
    const LocateResult stars = heights_.locate(points_, {}, AnswerBy::kStars);
    const std::span<const MapPoint> some = std::span(points_).first(asked_.splits);
    const LocateResult splits = heights_.locate(some, {}, AnswerBy::kSplits);
    EXPECT_EQ(all.cost.stars_read, 0U);
    EXPECT_EQ(stars.cost.records_applied, 0U);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      ASSERT_TRUE(are_same(all.points[i], stars.points[i])) << told(i);
      ASSERT_TRUE(i >= some.size() || are_same(all.points[i], splits.points[i])) << told(i);
      const LocateResult one = heights_.locate({&points_[i], 1}, {});
      ASSERT_TRUE(are_same(all.points[i], one.points[0])) << told(i);
    }
  }

  void expect_same_profiles() {
    std::vector<std::vector<MapPoint>> lines;
    for (std::size_t i = 0; i < asked_.lines; ++i) lines.push_back({any(), any(), any()});
    const ProfileResult heights = heights_.profile(lines, {});
    const ProfileResult stars = stars_.profile(lines, {});
    ASSERT_EQ(heights.points.size(), stars.points.size());
    for (std::size_t i = 0; i < stars.points.size(); ++i) {
      const ProfilePoint &a = heights.points[i], &b = stars.points[i];
      ASSERT_TRUE(a.position == b.position && are_same(a.distance, b.distance) &&
                  are_same(a.height, b.height) && a.state == b.state && a.line == b.line)
          << "point " << i << " of line " << b.line;
    }
  }

  void expect_same_in(const std::optional<Region>& region) {
    expect_same_isolines(region);
    expect_same_volumes(region);
    expect_same_tin(region);
  }

  void expect_same_raster(const std::optional<Window>& window) {
    const GridBox& b = facts().bounds;
    const MapPoint low =
        window ? MapPoint{window->min_x, window->min_y} : facts().map.to_map(b.min_x, b.min_y);
    const MapPoint high =
        window ? MapPoint{window->max_x, window->max_y} : facts().map.to_map(b.max_x, b.max_y);
    RasterRequest request;
    request.pixels = {0, 0, 61, 47};
    request.lattice = {low.x, low.y, (high.x - low.x) / 60, (high.y - low.y) / 46};
    std::vector<double> heights(61 * 47), stars(heights.size());
    std::vector<PointState> states(heights.size()), states_of_stars(heights.size());
    heights_.raster(request, heights, states);
    stars_.raster(request, stars, states_of_stars);
    EXPECT_EQ(states, states_of_stars);
    EXPECT_TRUE(std::equal(heights.begin(), heights.end(), stars.begin(),
                           [](double one, double other) { return are_same(one, other); }));
  }

  /// A window with its corners on samples, or anywhere.
  Window window() {
    const GridBox& b = facts().bounds;
    const double width = asked_.window_share * share() * (b.max_x - b.min_x);
    const double height = asked_.window_share * share() * (b.max_y - b.min_y);
    double x = b.min_x + share() * (b.max_x - b.min_x - width);
    double y = b.min_y + share() * (b.max_y - b.min_y - height);
    const bool on_samples = random_() % 2 == 0;
    if (on_samples) x = std::floor(x), y = std::floor(y);
    const auto end = [&](double from, double by) {
      return on_samples ? from + std::max(1.0, std::floor(by)) : from + by;
    };
    const MapPoint p = facts().map.to_map(x, y);
    const MapPoint q = facts().map.to_map(end(x, width), end(y, height));
    return {std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x), std::max(p.y, q.y)};
  }

 private:
  [[nodiscard]] const StoreFacts& facts() const { return heights_.store().facts(); }
  double share() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  const MapPoint& any() { return points_[random_() % points_.size()]; }
  [[nodiscard]] std::string told(std::size_t i) const {
    const MapPoint at = facts().map.to_grid(points_[i]);
    return "point " + std::to_string(at.x) + ", " + std::to_string(at.y) + " of the grid";
  }

  void expect_same_isolines(const std::optional<Region>& region) {
    IsolineRequest request;
    request.region = region;
    const double low = facts().min_height, high = facts().max_height;
    for (int i = 1; i < 4; ++i) request.levels.push_back(low + (high - low) * i / 4);
    request.levels.push_back(std::floor((low + high) / 2));  // most likely that of vertices
    const Listing heights = listing(heights_.isolines(request, AnswerBy::kHeights));
    EXPECT_EQ(heights, listing(heights_.isolines(request, AnswerBy::kStars)));
    if (asked_.splits > 0) {
      EXPECT_EQ(heights, listing(heights_.isolines(request, AnswerBy::kSplits)));
    }
  }

  void expect_same_volumes(const std::optional<Region>& region) {
    VolumeRequest request;
    request.region = region;
    const double levels[] = {facts().min_height, (facts().min_height + facts().max_height) / 2};
    const std::vector<VolumeResult> heights = heights_.volumes(request, levels);
    const std::vector<VolumeResult> stars = stars_.volumes(request, levels);
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const VolumeResult &a = heights[i], &b = stars[i];
      for (const auto& [one, other] :
           {std::pair{&a.cut, &b.cut}, {&a.fill, &b.fill}, {&a.net, &b.net}}) {
        EXPECT_TRUE(are_same(one->value, other->value)) << one->value << ", " << other->value;
        EXPECT_TRUE(are_same(one->low, other->low)) << one->low << ", " << other->low;
        EXPECT_TRUE(are_same(one->high, other->high)) << one->high << ", " << other->high;
      }
      EXPECT_TRUE(are_same(a.rounding, b.rounding)) << a.rounding << ", " << b.rounding;
      EXPECT_TRUE(are_same(a.void_area, b.void_area)) << a.void_area << ", " << b.void_area;
      EXPECT_TRUE(are_same(a.surface_area, b.surface_area));
      EXPECT_TRUE(are_same(a.mean_difference, b.mean_difference));
    }
  }

  /// The TIN of a region, and the whole one in parts, which by splits is T0 refined.
  void expect_same_tin(const std::optional<Region>& region) {
    RefineRequest request;
    request.region = region;
    request.form = ResultForm::kMeetingRegion;
    const std::vector<Corners> stars = canonical(stars_.refine(request).tin);
    EXPECT_TRUE(canonical(heights_.refine(request).tin) == stars);
    if (region) return;
    TinParts parts = heights_.parts({});
    Tin* const tin = parts.part(facts().bounds);
    ASSERT_NE(tin, nullptr);
    link_tin(*tin);
    EXPECT_TRUE(canonical(*tin) == stars);
  }

  Terrain heights_, stars_;
  AllWays asked_;
  std::mt19937_64 random_;
  std::vector<MapPoint> points_;
};

}  // namespace

std::vector<MapPoint> places_of_raster(const StoreFacts& facts, std::int64_t side,
                                       std::size_t count, std::mt19937_64& random) {
  const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const GridBox& b = facts.bounds;
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    double x = b.min_x - 0.1 + share() * (b.max_x - b.min_x + 0.2);
    double y = b.min_y - 0.1 + share() * (b.max_y - b.min_y + 0.2);
    const auto on_border = [&](double v) {
      return std::floor(v / static_cast<double>(side)) * static_cast<double>(side);
    };
    switch (i % 9) {
      case 1:  // a sample
        x = std::round(x), y = std::round(y);
        break;
      case 2:  // a side
        x = std::round(x);
        break;
      case 3:
        y = std::round(y);
        break;
      case 4:  // a centre, which lies on either diagonal
        x = std::floor(x) + 0.5, y = std::floor(y) + 0.5;
        break;
      case 5:  // a diagonal
        y = std::floor(y) + (random() % 2 == 0 ? x - std::floor(x) : std::ceil(x) - x);
        break;
      case 6:  // the border of a tile
        x = on_border(x);
        break;
      case 7:  // where tiles meet, or a sample on their border
        x = on_border(x), y = random() % 2 == 0 ? on_border(y) : std::round(y);
        break;
      case 8:  // on the border of the raster, or beside it
        x = random() % 2 == 0 ? b.min_x - static_cast<double>(random() % 2) : b.max_x;
        y = random() % 2 == 0 ? y : std::round(y);
        break;
      default:
        break;
    }
    points.push_back(facts.map.to_map(x, y));
  }
  return points;
}

void expect_same_by_all_ways(const Terrain& terrain, const AllWays& asked, std::uint64_t seed) {
  Ways ways(terrain, asked, seed);
  ways.expect_same_points();
  ways.expect_same_profiles();
  if (asked.asks_whole) {
    ways.expect_same_in({});
    ways.expect_same_raster({});
  }
  for (std::size_t i = 0; i < asked.windows && !testing::Test::HasFailure(); ++i) {
    const Window window = ways.window();
    ways.expect_same_in(window);
    ways.expect_same_raster(window);
  }
}

namespace {

std::uint64_t samples_of(const StoreFacts& facts) {
  const GridBox& b = facts.bounds;
  return (std::uint64_t(b.max_x - b.min_x) + 1) * (std::uint64_t(b.max_y - b.min_y) + 1);
}

void expect_few_reads_of_points(const Terrain& terrain, std::mt19937_64& random) {
  const StoreFacts& facts = terrain.store().facts();
  const GridBox& b = facts.bounds;
  const std::uint64_t levels = terrain.floor()->pages() <= 168 ? 1 : 2;
  constexpr int kPoints = 2000;
  const auto at = [&](std::int32_t low, std::int32_t high) {
    return low + static_cast<double>(random() % (std::uint64_t(high) - low));
  };
  std::uint64_t pages = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double x = at(b.min_x, b.max_x), y = at(b.min_y, b.max_y);
    const MapPoint within = facts.map.to_map(x + 0.375, y + 0.1875),
                   sample = facts.map.to_map(x, y);
    const LocateResult one = terrain.locate({&within, 1}, {}, AnswerBy::kHeights);
    ASSERT_EQ(one.cost.io.pages, 1U);
    ASSERT_EQ(one.cost.io.index_nodes, levels - 1) << "the root is in memory";
    pages += terrain.locate({&sample, 1}, {}, AnswerBy::kHeights).cost.io.pages;
  }
  EXPECT_LE(static_cast<double>(pages), 1.05 * kPoints);
}

void expect_few_reads_of_windows(const Terrain& terrain, double side, std::mt19937_64& random) {
  const StoreFacts& facts = terrain.store().facts();
  const GridBox& b = facts.bounds;
  const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const double pages = static_cast<double>(terrain.floor()->pages());
  const double width = side * (b.max_x - b.min_x), height = side * (b.max_y - b.min_y);
  const double filled = pages * (width + 1) * (height + 1) / static_cast<double>(samples_of(facts));
  constexpr int kWindows = 100;
  std::uint64_t read = 0;
  for (int i = 0; i < kWindows; ++i) {
    const double x = b.min_x + share() * (b.max_x - b.min_x - width);
    const double y = b.min_y + share() * (b.max_y - b.min_y - height);
    const MapPoint p = facts.map.to_map(x, y), q = facts.map.to_map(x + width, y + height);
    RefineRequest request;
    request.region =
        Window{std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x), std::max(p.y, q.y)};
    request.form = ResultForm::kMeetingRegion;
    read += terrain.refine(request).cost.io.pages;
  }
  const double most = 1.2 * (std::sqrt(filled) + 1) * (std::sqrt(filled) + 1);
  EXPECT_LE(static_cast<double>(read) / kWindows, most) << filled << " pages hold the samples";
}

}  // namespace

void expect_few_reads(const Terrain& terrain, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  expect_few_reads_of_points(terrain, random);
  if (!terrain.store().facts().free_of_voids) return;  // pages are not alike where voids are
  for (const double side : {0.01, 0.05, 0.2, 0.5}) {
    expect_few_reads_of_windows(terrain, side, random);
  }
}

void expect_few_rounds(const Terrain& terrain, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::vector<MapPoint> points = places_of_raster(terrain.store().facts(), 32, 3000, random);
  const test::Far far(test::bytes_of(terrain.store().path()));
  const LocateResult elsewhere = far.terrain.locate(points, {}, AnswerBy::kHeights);
  EXPECT_GT(far.source->rounds.size(), 0U);
  EXPECT_LE(far.source->rounds.size(), 3U);
  const LocateResult here = terrain.locate(points, {}, AnswerBy::kHeights);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_TRUE(are_same(elsewhere.points[i], here.points[i])) << i;
  }
}

}  // namespace ptin::reference
