// SPDX-License-Identifier: GPL-3.0-or-later
//
// Polygons between levels: areas and membership against the triangles, over random terrains.
#include "engine/query/isoline/isoline_bands.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

struct Surface {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

Surface surface_of(const Tin& tin, const StoreFacts& facts) {
  Surface s;
  for (const Vertex& v : tin.vertices) {
    const MapPoint p = facts.map.to_map(v.position.x, v.position.y);
    s.vertices.push_back({p.x, p.y, facts.heights.height(v.height)});
  }
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.is_alive(t) && tin.classes[t] == TriangleClass::kSurface) {
      s.triangles.push_back({tin.triangles[t].v[0], tin.triangles[t].v[1], tin.triangles[t].v[2]});
    }
  }
  return s;
}

double twice_area(const std::vector<MapPoint>& ring) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
    sum += (ring[i].x - ring[0].x) * (ring[i + 1].y - ring[0].y) -
           (ring[i + 1].x - ring[0].x) * (ring[i].y - ring[0].y);
  }
  return sum;
}

/// Twice the area of a triangle below a height: a formula of its own.
double twice_area_below(const std::array<std::array<double, 3>, 3>& t, double height) {
  std::array<std::array<double, 3>, 3> v = t;
  std::sort(v.begin(), v.end(), [](const auto& a, const auto& b) { return a[2] < b[2]; });
  const double all = std::abs((v[1][0] - v[0][0]) * (v[2][1] - v[0][1]) -
                              (v[2][0] - v[0][0]) * (v[1][1] - v[0][1]));
  const auto share = [&](double a, double b) { return (height - a) / (b - a); };
  if (height <= v[0][2]) return 0;
  if (height > v[2][2]) return all;
  if (height <= v[1][2]) return all * share(v[0][2], v[1][2]) * share(v[0][2], v[2][2]);
  return all * (1 - share(v[2][2], v[1][2]) * share(v[2][2], v[0][2]));
}

bool is_in(const BandPolygon& polygon, MapPoint p) {
  bool inside = false;
  for (const auto& ring : polygon.rings) {
    for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
      const MapPoint a = ring[i];
      const MapPoint b = ring[i + 1];
      if ((a.y <= p.y) != (b.y <= p.y) && a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) > p.x) {
        inside = !inside;
      }
    }
  }
  return inside;
}

std::vector<double> random_levels(std::mt19937_64& random, const reference::Hierarchy& h) {
  std::vector<double> levels;
  for (int i = 0; i < 4; ++i) {
    const Vertex& v = h.full.vertices[random() % h.full.vertices.size()];
    levels.push_back(h.facts.heights.height(v.height) + (i % 2 == 0 ? 0.0 : 0.1));
  }
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

RC_GTEST_PROP(BandPolygons, CoverTheirPartsOfTheSurface, (std::uint64_t seed)) {
  const reference::Hierarchy h = reference::random_hierarchy(seed);
  std::mt19937_64 random(seed);
  const Surface surface = surface_of(h.full, h.facts);
  const std::vector<double> levels = random_levels(random, h);
  const QueryContext context({.memory_bytes = std::uint64_t{1} << 30}, "test");
  const auto polygons = band_polygons({surface.vertices, surface.triangles}, levels, context);

  std::vector<double> wanted(levels.size() + 1), got(levels.size() + 1);
  for (const auto& t : surface.triangles) {
    const std::array<std::array<double, 3>, 3> v = {surface.vertices[t[0]], surface.vertices[t[1]],
                                                    surface.vertices[t[2]]};
    double below = 0;
    for (std::size_t b = 0; b <= levels.size(); ++b) {
      const double now = twice_area_below(v, b < levels.size() ? levels[b] : INFINITY);
      wanted[b] += now - below;
      below = now;
    }
  }
  double total = 0;
  for (const BandPolygon& p : polygons) {
    for (std::size_t r = 0; r < p.rings.size(); ++r) {
      const double area = twice_area(p.rings[r]);
      RC_ASSERT((r == 0) == (area > 0));
      RC_ASSERT(p.rings[r].size() >= 4U);
      RC_ASSERT(p.rings[r].front() == p.rings[r].back());
      got[p.band] += area;
      total += std::abs(area);
    }
  }
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    RC_ASSERT(std::abs(wanted[b] - got[b]) <= 1e-9 * (1 + total));
  }
  for (std::size_t i = 0; i < 20 && !surface.triangles.empty(); ++i) {
    const auto& t = surface.triangles[random() % surface.triangles.size()];
    std::uniform_real_distribution<double> share(0.01, 0.49);
    const double a = share(random), b = share(random);
    std::array<double, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = a * surface.vertices[t[0]][k] + b * surface.vertices[t[1]][k] +
             (1 - a - b) * surface.vertices[t[2]][k];
    }
    const auto band = std::upper_bound(levels.begin(), levels.end(), p[2]) - levels.begin();
    const bool near = std::any_of(levels.begin(), levels.end(),
                                  [&](double l) { return std::abs(l - p[2]) < 1e-6; });
    const auto holding = std::count_if(polygons.begin(), polygons.end(), [&](const auto& polygon) {
      return is_in(polygon, {p[0], p[1]});
    });
    if (!near) {
      RC_ASSERT(holding == 1);
      RC_ASSERT(std::any_of(polygons.begin(), polygons.end(), [&](const auto& polygon) {
        return polygon.band == band && is_in(polygon, {p[0], p[1]});
      }));
    }
  }
}

TEST(BandPolygons, OfAPeakAndARidgeExactlyAtALevelHaveNoPartAboveIt) {
  // A ridge of two vertices at 10, all else at 0.
  Surface s;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) s.vertices.push_back({x * 1.0, y * 1.0, 0.0});
  }
  s.vertices[5][2] = s.vertices[6][2] = 10.0;
  for (std::uint32_t y = 0; y < 2; ++y) {
    for (std::uint32_t x = 0; x < 3; ++x) {
      const std::uint32_t a = y * 4 + x;
      s.triangles.push_back({a, a + 1, a + 5});
      s.triangles.push_back({a, a + 5, a + 4});
    }
  }
  const QueryContext context({.memory_bytes = std::uint64_t{1} << 30}, "test");
  const std::vector<double> levels{10.0};
  const auto polygons = band_polygons({s.vertices, s.triangles}, levels, context);
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_EQ(polygons[0].band, 0U);
  EXPECT_EQ(polygons[0].rings.size(), 1U);
  EXPECT_EQ(twice_area(polygons[0].rings[0]), 12.0);
}

TEST(BandPolygons, RefuseWhatDoesNotFit) {
  Surface s;
  s.vertices = {{0, 0, 0}, {1, 0, 1000}, {0, 1, 0}};
  s.triangles = {{0, 1, 2}};
  std::vector<double> levels(1000);
  for (std::size_t i = 0; i < levels.size(); ++i) levels[i] = static_cast<double>(i) + 0.5;
  const QueryContext small({.memory_bytes = 1000}, "test");
  EXPECT_THROW(static_cast<void>(band_polygons({s.vertices, s.triangles}, levels, small)), Error);
  const QueryContext enough({.memory_bytes = 250000}, "test");
  EXPECT_EQ(band_polygons({s.vertices, s.triangles}, levels, enough).size(), 1001U);
}

}  // namespace
}  // namespace ptin
