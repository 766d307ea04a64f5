// SPDX-License-Identifier: GPL-3.0-or-later
//
// What an observer sees, against a sight line to every target over every edge of the full TIN.
#include "engine/query/sight/viewshed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "engine/mesh/raster_tin.h"
#include "engine/query/questions.h"
#include "engine/query/select/coarsest.h"
#include "engine/query/sight/viewshed_sweep.h"
#include "engine/query/sight/viewshed_walk.h"
#include "tests/query/built_terrain.h"
#include "tests/query/reference_hierarchy.h"
#include "tests/query/sight/sight_oracle.h"
#include "tests/support/least_memory.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::TemporaryStore;

/// How far the ray from the eye to a target clears the edges of the surface at its lowest, in the
/// height's unit; edges that it meets at the target or the eye alone do not count.
double clearance(const Hierarchy& h, MapPoint eye, double eye_z, MapPoint target, double target_z) {
  double least = INFINITY;
  const auto turn = [](MapPoint a, MapPoint b, MapPoint c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  const double length2 =
      (target.x - eye.x) * (target.x - eye.x) + (target.y - eye.y) * (target.y - eye.y);
  const auto at = [&](double x, double y, double z) {
    const double s =
        ((x - eye.x) * (target.x - eye.x) + (y - eye.y) * (target.y - eye.y)) / length2;
    if (s > 1e-9 && s < 1 - 1e-9) least = std::min(least, eye_z + s * (target_z - eye_z) - z);
  };
  for (TriangleId t = 0; t < h.full.triangles.size(); ++t) {
    if (h.full.classes[t] != TriangleClass::kSurface) continue;
    for (int i = 0; i < 3; ++i) {
      const Vertex& va = h.full.vertices[h.full.triangles[t].v[i]];
      const Vertex& vb = h.full.vertices[h.full.triangles[t].v[(i + 1) % 3]];
      const MapPoint a = h.facts.map.to_map(va.position.x, va.position.y);
      const MapPoint b = h.facts.map.to_map(vb.position.x, vb.position.y);
      const double za = h.facts.heights.height(va.height);
      const double zb = h.facts.heights.height(vb.height);
      const double da = turn(eye, target, a);
      const double db = turn(eye, target, b);
      if (da == 0) at(a.x, a.y, za);
      if (db == 0) at(b.x, b.y, zb);
      if ((da < 0) != (db < 0) && da != 0 && db != 0) {
        const double s = da / (da - db);
        at(a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), za + s * (zb - za));
      }
    }
  }
  return least;
}

std::vector<Offset> offsets_of(const Hierarchy& h, MapPoint eye, double eye_height) {
  std::vector<Offset> offsets;
  for (const Vertex& v : h.full.vertices) {
    offsets.push_back({v.position.x - eye.x, v.position.y - eye.y,
                       h.facts.heights.height(v.height) - eye_height});
  }
  return offsets;
}

RC_GTEST_PROP(Viewshed, IsASightLineToEveryVertexAndPixel, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  // A third with voids, and grid points between the samples: so on the rims too.
  const auto size = [&] { return 3 + static_cast<int>(random() % 12); };
  const Hierarchy h =
      seed % 3 == 0
          ? reference::simplify(reference::random_grid(random, size(), size(), 2, 0.15), random, {})
          : reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  ViewshedRequest request;
  const GridBox& b = h.facts.bounds;
  double x = double(b.min_x) + double(random() % std::uint64_t(b.max_x - b.min_x + 1));
  double y = double(b.min_y) + double(random() % std::uint64_t(b.max_y - b.min_y + 1));
  if (random() % 2 == 0)
    x = std::min<double>(x + 0.375, b.max_x), y = std::min<double>(y + 0.28125, b.max_y);
  request.eye = h.facts.map.to_map(x, y);
  request.absolute = random() % 2 == 0;
  request.eye_height = request.absolute ? h.facts.max_height * 0.7 : double(random() % 3);
  request.target_height = random() % 3 == 0 ? 0.5 : 0.0;
  request.curvature.coefficient = 0;
  request.radius =
      (1 + double(random() % 30)) / 40 * double(half_perimeter(b)) * h.facts.map.step_x;
  if (random() % 2 == 0)
    request.pixel_size = std::array{h.facts.map.step_x * 0.71, h.facts.map.step_x * 0.71};
  Viewshed seen{};
  try {
    seen = viewshed(terrain, request);
  } catch (const Error& error) {
    RC_ASSERT(error.code() == ErrorCode::invalid_argument);  // on a void
    RC_ASSERT(!request.absolute || std::string(error.what()).find("outside") != std::string::npos ||
              std::string(error.what()).find("below") != std::string::npos);
    return;
  }
  const Spot eye = *SpotMap(h.facts.map, h.facts.bounds).spot(request.eye);
  const std::vector<Offset> offsets = offsets_of(h, grid_of(eye), seen.eye_height);
  const WalkedView walked(h.full, offsets, eye);  // what a ring of triangles falls back to
  std::map<std::pair<double, double>, bool> visible;
  for (const Viewshed::Target& v : seen.vertices) {
    visible[{v.position.x, v.position.y}] = v.visible;
    if (v.position == request.eye) continue;
    const double c =
        clearance(h, request.eye, seen.eye_height, v.position, v.height + request.target_height);
    // Rounding of this oracle; at whole clearances the answers must agree.
    if (std::abs(c) > 1e-9) RC_ASSERT(v.visible == (c > 0));
    const MapPoint g = h.facts.map.to_grid(v.position);
    const GridPoint p{static_cast<std::int32_t>(std::llround(g.x)),
                      static_cast<std::int32_t>(std::llround(g.y))};
    const double z = v.height + request.target_height - seen.eye_height;
    if (std::abs(c) > 1e-9) RC_ASSERT(walked.sees(spot_of(p), z, 0) == (c > 0));
  }
  std::size_t expected = 0;
  for (VertexId v = 0; v < h.full.vertices.size(); ++v) {
    const GridPoint p = h.full.position(v);
    const MapPoint at = h.facts.map.to_map(p.x, p.y);
    bool surface = false;
    for (TriangleId t = 0; t < h.full.triangles.size(); ++t) {
      const auto& c = h.full.triangles[t].v;
      surface = surface ||
                (h.full.classes[t] == TriangleClass::kSurface && std::find(c, c + 3, v) != c + 3);
    }
    const double d = std::hypot(at.x - request.eye.x, at.y - request.eye.y);
    if (surface && d < request.radius * (1 - 1e-9)) {
      ++expected;
      RC_ASSERT(visible.contains({at.x, at.y}));
    }
  }
  RC_ASSERT(seen.vertices.size() >= expected);
  for (int sample = 0; sample < 60; ++sample) {
    {
      const auto row = static_cast<std::uint32_t>(random() % seen.height);
      const auto column = static_cast<std::uint32_t>(random() % seen.width);
      const Sight s = seen.pixels[std::size_t{row} * seen.width + column];
      const MapPoint at{seen.first.x + column * seen.step_x, seen.first.y - row * seen.step_y};
      const MapPoint g = h.facts.map.to_grid(at);
      const GridPoint centre{static_cast<std::int32_t>(std::llround(g.x)),
                             static_cast<std::int32_t>(std::llround(g.y))};
      for (TriangleId t = 0; t < h.full.triangles.size(); ++t) {
        if (h.full.classes[t] != TriangleClass::kSurface) continue;
        double w[3], z = 0, sum = 0;
        for (int i = 0; i < 3; ++i) {
          const GridPoint p = h.full.position(h.full.triangles[t].v[(i + 1) % 3]);
          const GridPoint q = h.full.position(h.full.triangles[t].v[(i + 2) % 3]);
          const MapPoint a = h.facts.map.to_map(p.x, p.y);
          const MapPoint c = h.facts.map.to_map(q.x, q.y);
          w[i] = (a.x - at.x) * (c.y - at.y) - (a.y - at.y) * (c.x - at.x);
          z += w[i] * h.facts.heights.height(h.full.vertices[h.full.triangles[t].v[i]].height);
          sum += w[i];
        }
        // Borders count where the pixels are grid points, so that they are decided exactly.
        const auto& v = h.full.triangles[t].v;
        const bool on_grid = !request.pixel_size;
        if (on_grid) {
          const auto corner = [&](int i) { return h.full.position(v[i % 3]); };
          bool inside = true;
          for (int i = 0; i < 3; ++i) inside &= orient(corner(i), corner(i + 1), centre) >= 0;
          if (!inside) continue;
        } else if (std::min({w[0], w[1], w[2]}) <= 1e-6) {
          continue;
        }
        const double d = std::hypot(at.x - request.eye.x, at.y - request.eye.y);
        if (d > request.radius * (1 + 1e-9)) RC_ASSERT(s == Sight::kNothing);
        if (d >= request.radius * (1 - 1e-9) || d < 1e-9) continue;
        const double c =
            clearance(h, request.eye, seen.eye_height, at, z / sum + request.target_height);
        RC_ASSERT(s != Sight::kNothing);
        if (std::abs(c) > 1e-9) RC_ASSERT((s == Sight::kVisible) == (c > 0));
      }
    }
  }
}

/// Heights 0 but for a wall.
Hierarchy plain_with_wall(double wall) {
  std::mt19937_64 random(1);
  Tin full = reference::random_grid(random, 21, 21, 1, 0.0);
  const HeightEncoding heights{HeightType::int32, 0.25, -3.0};
  for (Vertex& v : full.vertices) {
    v.height = heights.bits(((v.position.x == 14 ? wall : 0.0) + 3.0) / 0.25);
  }
  return reference::simplify_unmeasured(std::move(full), random);
}

TEST(Viewshed, OfAPlainFromItsOwnHeightTouchesAndSeesEverything) {
  const Hierarchy h = plain_with_wall(0.0);
  const TemporaryStore file(h);
  ViewshedRequest request;
  request.eye = h.facts.map.to_map(7, 9);
  request.radius = 1000;
  request.curvature.coefficient = 0;
  const Viewshed seen = viewshed(Terrain(file.open()), request);
  EXPECT_EQ(seen.vertices.size(), 441U);
  EXPECT_TRUE(std::all_of(seen.vertices.begin(), seen.vertices.end(),
                          [](const Viewshed::Target& t) { return t.visible; }));
  EXPECT_EQ(seen.hidden_pixels, 0U);
}

/// Plain ground around a void, cells of two grid units: pixels at every corner and on the middle of
/// every side, so that the rim of the void has pixels of its own.
TEST(Viewshed, AnswersOnTheRimOfAVoidSeenAcrossIt) {
  std::mt19937_64 random(1);
  Tin full = reference::random_grid(random, 5, 5, 2, 0.0);
  const HeightEncoding heights{HeightType::int32, 0.25, -3.0};
  for (Vertex& v : full.vertices) v.height = heights.bits(12);
  for (TriangleId t = 0; t < full.triangles.size(); ++t) {
    for (const VertexId v : full.triangles[t].v) {
      if (full.position(v) == GridPoint{4, 4}) full.classes[t] = TriangleClass::kVoid;
    }
  }
  const Hierarchy h = reference::simplify_unmeasured(std::move(full), random);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  for (const bool by_size : {false, true}) {
    for (int y = 0; y <= 8; ++y) {
      for (int x = 0; x <= 8; ++x) {
        ViewshedRequest request;
        request.eye = h.facts.map.to_map(x, y);
        request.eye_height = 5;
        request.absolute = true;
        request.curvature.coefficient = 0;
        request.radius = 12 * h.facts.map.step_x;
        if (by_size) request.pixel_size = std::array{h.facts.map.step_x, h.facts.map.step_x};
        const Viewshed seen = viewshed(terrain, request);
        for (std::uint32_t row = 0; row < seen.height; ++row) {
          for (std::uint32_t column = 0; column < seen.width; ++column) {
            const MapPoint g = h.facts.map.to_grid(
                {seen.first.x + column * seen.step_x, seen.first.y - row * seen.step_y});
            const GridPoint p{static_cast<std::int32_t>(std::llround(g.x)),
                              static_cast<std::int32_t>(std::llround(g.y))};
            bool surface = false;
            for (TriangleId t = 0; t < h.full.triangles.size(); ++t) {
              const auto corner = [&](int i) {
                return h.full.position(h.full.triangles[t].v[i % 3]);
              };
              bool inside = h.full.classes[t] == TriangleClass::kSurface;
              for (int i = 0; i < 3; ++i) inside &= orient(corner(i), corner(i + 1), p) >= 0;
              surface = surface || inside;
            }
            EXPECT_EQ(seen.pixels[std::size_t{row} * seen.width + column],
                      surface ? Sight::kVisible : Sight::kNothing)
                << "eye " << x << " " << y << ", pixel " << p.x << " " << p.y;
          }
        }
      }
    }
  }
}

/// A triangle around the eye and a larger one turned by 140 degrees, joined by six that each lie in
/// front of the next: a ring without order.
Hierarchy pinwheel(std::mt19937_64& random) {
  CoarsestTin t;
  const HeightEncoding heights{HeightType::int32, 0.25, -3.0};
  const auto add = [&](double radius, double degrees) {
    const double angle = degrees / 180 * std::acos(-1.0);
    t.vertices.push_back({{static_cast<std::int32_t>(std::lround(1000 + radius * std::cos(angle))),
                           static_cast<std::int32_t>(std::lround(1000 + radius * std::sin(angle)))},
                          heights.bits(static_cast<double>(random() % 160)),
                          1});
  };
  for (int i = 0; i < 3; ++i) add(100, 120 * i + 7);
  for (int i = 0; i < 3; ++i) add(1000, 120 * i + 147);
  t.triangles.push_back({{0, 1, 2}, 0});
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint32_t next = (i + 1) % 3;
    t.triangles.push_back({{next, i, 3 + i}, 0});
    t.triangles.push_back({{next, 3 + i, 3 + next}, 0});
  }
  reference::Options options;
  options.left = 1.0;
  return reference::simplify(mesh_of(t, "pinwheel"), random, options);
}

TEST(Viewshed, WalksWhereTrianglesHideOneAnotherInARing) {
  std::mt19937_64 random(3);
  int hidden = 0;
  for (int i = 0; i < 200; ++i) {
    const Hierarchy h = pinwheel(random);
    const TemporaryStore file(h);
    ViewshedRequest request;
    request.eye = h.facts.map.to_map(1003, 996);
    request.eye_height = 3;
    request.radius = 1e9;
    request.pixel_size = std::array{h.facts.map.step_x * 90, h.facts.map.step_x * 90};
    request.curvature.coefficient = 0;
    request.target_height = 0.25;
    request.radius = h.facts.map.step_x * 1000;
    const Viewshed seen = viewshed(Terrain(file.open()), request);
    EXPECT_GT(seen.walked_targets, 20U);
    for (const Viewshed::Target& v : seen.vertices) {
      const double c =
          clearance(h, request.eye, seen.eye_height, v.position, v.height + request.target_height);
      EXPECT_TRUE(std::abs(c) < 1e-9 || v.visible == (c > 0));
    }
    hidden += static_cast<int>(seen.hidden_pixels);
  }
  EXPECT_GT(hidden, 100);
}

/// Whatever a level of detail is certain of is what the full TIN answers. @returns how many pixels
/// it is certain of.
std::uint64_t check_certainty(const Viewshed& exact, const Viewshed& level) {
  EXPECT_EQ(exact.width, level.width);
  EXPECT_EQ(exact.height, level.height);
  EXPECT_EQ(exact.undecided_pixels, 0U);
  std::uint64_t certain = 0, undecided = 0, wrong = 0;
  for (std::size_t i = 0; i < level.pixels.size(); ++i) {
    const Sight s = level.pixels[i];
    const bool is_target = exact.pixels[i] != Sight::kNothing;  // not a void that is filled
    certain += is_certain(s) ? 1 : 0;
    undecided += s != Sight::kNothing && !is_certain(s) ? 1 : 0;
    wrong += is_target && is_certain(s) && s != exact.pixels[i] ? 1 : 0;
  }
  EXPECT_EQ(certain, level.visible_pixels + level.hidden_pixels);
  EXPECT_EQ(undecided, level.undecided_pixels);
  EXPECT_EQ(wrong, 0U);
  std::map<std::pair<double, double>, bool> truth;
  for (const Viewshed::Target& t : exact.vertices) {
    truth[{t.position.x, t.position.y}] = t.visible;
  }
  for (const Viewshed::Target& t : level.vertices) {
    const auto at = truth.find({t.position.x, t.position.y});
    EXPECT_TRUE(!t.certain || at == truth.end() || at->second == t.visible);
  }
  return certain;
}

RC_GTEST_PROP(Viewshed, AtALevelOfDetailIsNeverWrongWhereItIsCertain, (std::uint64_t seed)) {
  const reference::SmallTerrain t(seed);
  const StoreFacts& f = t.terrain->store().facts();
  std::mt19937_64 random(seed);
  for (int i = 0; i < 3; ++i) {
    ViewshedRequest request;
    const GridBox& b = f.bounds;
    request.eye =
        f.map.to_map(b.min_x + double(random() % std::uint64_t(b.max_x - b.min_x + 1)),
                     b.min_y + double(random() % std::uint64_t(b.max_y - b.min_y + 1)) * 0.999);
    request.absolute = random() % 3 == 0;
    request.eye_height = request.absolute ? f.max_height : double(random() % 5);
    request.target_height = double(random() % 4);
    request.curvature.coefficient = 0;
    request.radius = f.map.step_x * (3 + double(random() % 50));
    if (random() % 2 == 0)
      request.pixel_size = std::array{f.map.step_x * 0.71, f.map.step_x * 0.71};
    try {
      const Viewshed exact = viewshed(*t.terrain, request);
      if (random() % 2 == 0) {
        request.detail.tolerance = double(random() % 60) / 10;
      } else {
        request.detail.vertices = t.terrain->store().t0().vertices.size() +
                                  random() % (t.terrain->store().record_count() + 2);
      }
      static_cast<void>(check_certainty(exact, viewshed(*t.terrain, request)));
    } catch (const Error& error) {
      RC_ASSERT(error.code() == ErrorCode::invalid_argument);  // outside, or on a void
    }
    RC_ASSERT(!::testing::Test::HasFailure());
  }
}

/// What two ways to a viewshed see differently, where that is more than a rounding: targets a millionth of
/// a unit higher are seen by both.
std::size_t unlike(const OpenedTerrain& a, const OpenedTerrain& b, ViewshedRequest request) {
  const Viewshed by_a = viewshed(a, request), by_b = viewshed(b, request);
  if (by_a.pixels == by_b.pixels) {
    return 0;
  }
  request.target_height += 1e-6;
  const Viewshed higher_a = viewshed(a, request), higher_b = viewshed(b, request);
  std::size_t count = by_a.pixels.size() == by_b.pixels.size() ? 0 : 1;
  for (std::size_t i = 0; count == 0 && i < by_a.pixels.size(); ++i) {
    const bool is_tie =
        higher_a.pixels[i] == Sight::kVisible && higher_b.pixels[i] == Sight::kVisible;
    count += by_a.pixels[i] != by_b.pixels[i] && !is_tie ? 1 : 0;
  }
  return count;
}

/// The mesh of the grid and that of records have their triangles in different orders, and each triangle
/// another first corner. Sweeps take them in these orders, so only what a rounding decides may differ.
RC_GTEST_PROP(Viewshed, FromHeightsIsThatBySplits, (std::uint64_t seed)) {
  const reference::SmallTerrain t(seed);
  OpenedTerrain stars = *t.terrain;
  stars.use_floor(false);
  const StoreFacts& f = t.terrain->store().facts();
  std::mt19937_64 random(seed);
  ViewshedRequest request;
  request.eye = f.map.to_map(double(random() % std::uint64_t(f.bounds.max_x + 2)),
                             double(random() % std::uint64_t(f.bounds.max_y + 2)) * 0.999);
  request.absolute = random() % 3 == 0;
  request.eye_height = request.absolute ? f.max_height : double(random() % 3);
  request.target_height = double(random() % 3);
  request.radius = f.map.step_x * (1 + double(random() % 50));
  if (random() % 2 == 0) {
    request.pixel_size = std::array{f.map.step_x * 0.71, f.map.step_x * 0.71};
  }
  try {
    const Viewshed expected = viewshed(stars, request);
    const Viewshed found = viewshed(*t.terrain, request);
    RC_ASSERT(unlike(*t.terrain, stars, request) == 0U);
    RC_ASSERT(found.vertices.size() == expected.vertices.size());
    std::size_t seen_unlike = 0;
    for (std::size_t i = 0; i < found.vertices.size(); ++i) {
      RC_ASSERT(found.vertices[i].position.x == expected.vertices[i].position.x);
      RC_ASSERT(found.vertices[i].position.y == expected.vertices[i].position.y);
      RC_ASSERT(found.vertices[i].height == expected.vertices[i].height);
      seen_unlike += found.vertices[i].visible != expected.vertices[i].visible ? 1 : 0;
    }
    RC_ASSERT(seen_unlike <= 2 + found.vertices.size() / 1000);
  } catch (const Error& error) {
    RC_ASSERT(error.code() == ErrorCode::invalid_argument);  // outside, or on a void
    RC_ASSERT_THROWS_AS(viewshed(*t.terrain, request), Error);
  }
}

/// From the middle of a bowl each place is seen. Centres of pixels that stand on lines of samples, or in
/// line with edges, are off these by their rounding. Half as wide, where not all cases are asked for.
TEST(Viewshed, OfABowlHasAllPixels) {
  const int side = 1 + 600 / test::share_of_cases(2), middle = side / 2;
  std::vector<HeightBits> heights;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      heights.push_back(
          static_cast<HeightBits>((x - middle) * (x - middle) + (y - middle) * (y - middle)));
    }
  }
  StoreFacts facts;
  facts.map = {0.0, 0.0, 1.0, 1.0};
  facts.bounds = {0, 0, side - 1, side - 1};
  facts.heights = {HeightType::int32, 1.0, 0.0};
  facts.max_height = 2.0 * middle * middle;
  const std::vector<std::uint8_t> valid(heights.size(), 1);
  const Tin tin = make_raster_tin(heights, valid, {0, 0, side, side}, facts.heights);
  ViewshedRequest request;
  request.eye = {double(middle), double(middle)};
  request.radius = middle - 1;
  request.curvature.coefficient = 0;
  request.list_vertices = false;
  request.target_height = 1e-6;  // on an edge the last digit of a height would decide
  for (const double size : {0.71, 0.37, 0.3, 0.1}) {
    request.pixel_size = std::array{size, size};
    const Viewshed seen =
        sweep_viewshed(tin, facts, request, QueryContext(request.limits, ""), {}, {});
    std::size_t hidden = 0, nothing = 0;
    for (std::uint32_t row = 0; row < seen.height; ++row) {
      for (std::uint32_t column = 0; column < seen.width; ++column) {
        const double x = size * (double(column) - double(seen.width / 2));
        const double y = size * (double(row) - double(seen.height / 2));
        if (x * x + y * y > (request.radius - 1) * (request.radius - 1)) continue;
        const Sight at = seen.pixels[std::size_t{row} * seen.width + column];
        hidden += at == Sight::kHidden ? 1 : 0;
        nothing += at == Sight::kNothing ? 1 : 0;
      }
    }
    EXPECT_EQ(hidden, 0U) << size;
    EXPECT_EQ(nothing, 0U) << size;
  }
}

TEST(Viewshed, OfMountainsIsMostlyCertainAtAnError) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  OpenedTerrain stars = terrain;
  stars.use_floor(false);
  const StoreFacts& f = terrain.store().facts();
  std::uint64_t hidden = 0, visible = 0, targets = 0;
  for (int i = 0; i < 6; ++i) {
    ViewshedRequest request;
    request.eye = f.map.to_map(40 + 37 * i, 200 - 31 * i);
    request.eye_height = 10;
    request.target_height = i % 2 == 0 ? 0 : 30;
    request.radius = 60 * f.map.step_x;
    const Viewshed exact = viewshed(terrain, request);
    const ViewshedRequest request_in_full = request;
    request.detail.tolerance = 2;
    const Viewshed level = viewshed(terrain, request);
    static_cast<void>(check_certainty(exact, level));
    EXPECT_FALSE(level.exact);
    hidden += level.hidden_pixels;
    visible += level.visible_pixels;
    targets += level.hidden_pixels + level.visible_pixels + level.undecided_pixels;
    EXPECT_LT(level.cost.records_applied, viewshed(stars, request_in_full).cost.records_applied);
    if (request.target_height == 0) {
      EXPECT_LE(level.visible_pixels, 1U);  // the eye's own
    }
  }
  EXPECT_GT(hidden, targets / 5);
  EXPECT_GT(visible, targets / 50);
}

TEST(Viewshed, EndsBehindAWall) {
  const Hierarchy h = plain_with_wall(5.0);
  const TemporaryStore file(h);
  ViewshedRequest request;
  request.eye = h.facts.map.to_map(7, 9);
  request.eye_height = 2;
  request.radius = 1000;
  request.curvature.coefficient = 0;
  const Terrain terrain(file.open());
  for (const Viewshed::Target& t : viewshed(terrain, request).vertices) {
    EXPECT_EQ(t.visible, h.facts.map.to_grid(t.position).x < 14.5)
        << h.facts.map.to_grid(t.position).x << " " << h.facts.map.to_grid(t.position).y;
  }
  request.curvature = {1.0,
                       2.0};  // a ball: what is beyond a few units is below the plain's horizon
  EXPECT_LT(viewshed(terrain, request).visible_pixels, 100U);
}

TEST(Viewshed, CountsTheRastersThatAFileWithoutItsDetailsNeeds) {
  Hierarchy h = plain_with_wall(5.0);
  ViewshedRequest request;
  request.eye = h.facts.map.to_map(7, 9);
  request.eye_height = 2;
  request.radius = 20 * h.facts.map.step_x;
  request.pixel_size = std::array{h.facts.map.step_x / 16, h.facts.map.step_x / 16};
  request.list_vertices = false;
  const TemporaryStore whole(h);
  h.facts.base_deviation = 0.5;  // larger than rounding: details were left out
  const TemporaryStore without(h);
  const Terrain exact(whole.open());
  const Terrain left_out(without.open());
  const std::uint64_t raster = viewshed(exact, request).pixels.size();
  ASSERT_GT(raster, 1U << 18U);
  // One sweep is held while the next tells what is certain.
  const auto least = [&](const Terrain& terrain) {
    return reference::least_memory(
        [&](std::uint64_t limit) {
          request.limits.memory_bytes = limit;
          static_cast<void>(viewshed(terrain, request));
        },
        1U << 14U);
  };
  EXPECT_NEAR(double(least(left_out)), double(least(exact) + raster), 1U << 15U);
}

TEST(Viewshed, CountsItsMeshBesideItsResults) {
  std::mt19937_64 random(8);
  const Hierarchy h =
      reference::simplify_unmeasured(reference::random_grid(random, 40, 40, 4, 0.0), random);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  const GridBox& b = h.facts.bounds;
  ViewshedRequest request;
  request.eye = h.facts.map.to_map(0.5 * (b.min_x + b.max_x), 0.5 * (b.min_y + b.max_y));
  request.eye_height = 20;
  request.radius = (b.max_x - b.min_x) * h.facts.map.step_x;  // all of it
  const std::uint64_t mesh = h.full.vertices.size() * (sizeof(Vertex) + 1) +
                             h.full.triangles.size() * (sizeof(Triangle) + 1);
  for (const bool listed : {false, true}) {
    request.list_vertices = listed;
    Viewshed seen;
    const std::uint64_t least = reference::least_memory([&](std::uint64_t limit) {
      request.limits.memory_bytes = limit;
      seen = viewshed(terrain, request);
    });
    EXPECT_EQ(seen.vertices.size(), listed ? h.full.vertices.size() : 0U);
    EXPECT_GE(least, mesh + seen.pixels.size() + seen.vertices.size() * sizeof(Viewshed::Target));
  }
}

TEST(Viewshed, RefusesWhatMeansNothing) {
  const Hierarchy h = plain_with_wall(0.0);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  ViewshedRequest request;
  request.eye = h.facts.map.to_map(7, 9);
  EXPECT_THROW(static_cast<void>(viewshed(terrain, request)), Error) << "no radius";
  request.radius = 1;
  request.eye.x -= 1e6;
  EXPECT_THROW(static_cast<void>(viewshed(terrain, request)), Error) << "outside";
  request.eye = h.facts.map.to_map(7, 9);
  request.target_height = -1;
  EXPECT_THROW(static_cast<void>(viewshed(terrain, request)), Error);
}

}  // namespace
}  // namespace ptin
