// SPDX-License-Identifier: GPL-3.0-or-later
//
// TINs as sources: what becomes of concave, broken, hidden and flattened triangles.
#include "engine/construct/tin/tin_source.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/tin/void_sweep.h"
#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "engine/mesh/link.h"
#include "engine/mesh/validate.h"
#include "tests/construct/delaunay_tin.h"
#include "tests/construct/tin/tin_fixture.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using namespace tin_test;

TEST(TinSource, TakesAConvexTinAsItIs) {
  const TinTerrain terrain = read(kSquare, kTwo);
  expect_sound(terrain, 2, 0);
  EXPECT_EQ(terrain.frame.min_height, 1.0);
  EXPECT_EQ(terrain.frame.max_height, 4.0);
  EXPECT_EQ(terrain.largest_shift_plan, 0.0);
}

TEST(TinSource, TurnsATinThatIsClockwiseThroughout) {
  expect_sound(read(kSquare, {{2, 1, 0}, {3, 2, 0}}), 2, 0);
}

TEST(TinSource, TurnsSingleTriangles) {
  std::vector<Vertex3> strip = kSquare;
  strip.push_back({20, 0, 0});
  expect_sound(read(strip, {{0, 1, 2}, {0, 2, 3}, {4, 1, 2}}), 3, 0);
  expect_sound(read(kSquare, {{0, 1, 2}, {3, 2, 0}}), 2, 0);
}

/// The surface triangles of the quads of an OBJ file.
std::set<KeyTriangle> cut(const std::vector<Vertex3>& vertices, const std::string& faces,
                          const SourceOptions& options = {}) {
  const TestFile file(".obj", obj_of(vertices, {}) + faces);
  return triangles_of(TinTerrain(triangles_in(file.path(), options)).tin, TriangleClass::kSurface);
}

TEST(TinSource, CutsQuadsAsCellsOfRastersAre) {
  const auto keys = [](const std::vector<Face>& faces, const std::vector<GridPoint>& at) {
    std::set<KeyTriangle> all;
    for (const Face& f : faces) {
      KeyTriangle t{};
      for (std::size_t i = 0; i < 3; ++i) t[i] = key_of(at[static_cast<std::size_t>(f[i])]);
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      all.insert(t);
    }
    return all;
  };
  const std::vector<GridPoint> square = {{0, 0}, {9, 0}, {9, 9}, {0, 9}};
  const auto with_heights = [](double a, double b, double c, double d) {
    return std::vector<Vertex3>{{0, 0, a}, {9, 0, b}, {9, 9, c}, {0, 9, d}};
  };
  const auto rising = keys({{0, 1, 2}, {0, 2, 3}}, square);
  const auto falling = keys({{0, 1, 3}, {1, 2, 3}}, square);
  // Whichever corner comes first, and whichever way round.
  for (const char* quad : {"f 1 2 3 4\n", "f 2 3 4 1\n", "f 4 3 2 1\n", "f 3 2 1 4\n"}) {
    EXPECT_EQ(cut(with_heights(0, 5, 1, 9), quad), rising) << quad;
    EXPECT_EQ(cut(with_heights(5, 0, 9, 1), quad), falling) << quad;
    EXPECT_EQ(cut(with_heights(1, 2, 3, 4), quad), rising) << quad << "from the least corner";
  }
  // Only one diagonal lies inside of a dart.
  const std::vector<Vertex3> dart = {{0, 0, 0}, {9, 0, 50}, {3, 3, 70}, {0, 9, 50}};
  EXPECT_EQ(cut(dart, "f 1 2 3 4\n"),
            keys({{0, 1, 2}, {0, 2, 3}}, {{0, 0}, {9, 0}, {3, 3}, {0, 9}}));
  // The shorter diagonal counts where heights are equal.
  const std::vector<Vertex3> kite = {{0, 0, 1}, {9, 0, 1}, {20, 20, 1}, {0, 9, 1}};
  EXPECT_EQ(cut(kite, "f 1 2 3 4\n"),
            keys({{0, 1, 3}, {1, 2, 3}}, {{0, 0}, {9, 0}, {20, 20}, {0, 9}}));
  // A corner without a height leaves the triangle of the others.
  SourceOptions options;
  options.nodata = -1.0;
  EXPECT_EQ(cut(with_heights(0, 1, 2, -1), "f 1 2 3 4\n", options).size(), 1U);
  const TestFile bow(".obj", obj_of(kSquare, {}) + "f 1 3 2 4\n");
  EXPECT_THROW(static_cast<void>(triangles_in(bow.path())), Error);
}

TEST(TinSource, FillsConcaveBordersHolesAndGaps) {
  // An L: one pocket.
  const std::vector<Vertex3> corner = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0},
                                       {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  expect_sound(read(corner, {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}}), 4, 1);
  // A ring around a hole.
  const std::vector<Vertex3> ring = {{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {0, 9, 0},
                                     {3, 3, 0}, {6, 3, 0}, {6, 6, 0}, {3, 6, 0}};
  expect_sound(
      read(
          ring,
          {{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}}),
      8, 2);
  // Two islands, and two triangles that touch in a vertex.
  const std::vector<Vertex3> islands = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                        {8, 8, 0}, {9, 8, 0}, {8, 9, 0}};
  expect_sound(read(islands, {{0, 1, 2}, {3, 4, 5}}), 2, 3);
  const std::vector<Vertex3> bow = {{0, 0, 0}, {4, 2, 0}, {0, 4, 0}, {8, 0, 0}, {8, 4, 0}};
  expect_sound(read(bow, {{0, 1, 2}, {1, 3, 4}}), 2, 2);
  // A lake with an island in it.
  std::vector<Vertex3> lake = ring;
  lake.insert(lake.end(), {{4, 4, 0}, {5, 4, 0}, {4, 5, 0}});
  expect_sound(read(lake, {{0, 1, 5},
                           {0, 5, 4},
                           {1, 2, 6},
                           {1, 6, 5},
                           {2, 3, 7},
                           {2, 7, 6},
                           {3, 0, 4},
                           {3, 4, 7},
                           {8, 9, 10}}),
               9, 7);
}

TEST(TinSource, NamesEveryFault) {
  EXPECT_NE(refusal({{0, 0, 0}, {4, 0, 0}, {8, 0, 0}, {0, 4, 0}}, {{0, 1, 2}, {0, 2, 3}})
                .find("1 triangle has no area (it is at 0 0)"),
            std::string::npos);
  // A surface that folds over itself: each triangle by itself is one.
  EXPECT_NE(refusal({{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {6, 5, 3}}, {{0, 1, 2}, {0, 2, 3}})
                .find("1 edge has two triangles"),
            std::string::npos);
  EXPECT_NE(refusal(kSquare, {{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}).find("3 edges have two triangles"),
            std::string::npos);
  EXPECT_NE(refusal({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 0, 9}, {4, 4, 0}}, {{0, 1, 2}, {3, 4, 2}})
                .find("1 position has several heights (it is at 4 0)"),
            std::string::npos);
  // The long side of the first is two sides of the others.
  EXPECT_NE(refusal({{0, 0, 0}, {8, 0, 0}, {4, 8, 0}, {4, 0, 0}, {4, -5, 0}},
                    {{0, 1, 2}, {0, 4, 3}, {3, 4, 1}})
                .find("1 vertex lies inside of an edge (T-junction) (it is at 4 0)"),
            std::string::npos);
  EXPECT_NE(refusal({{0, 0, 0}, {8, 0, 0}, {4, 8, 0}, {3, -2, 0}, {5, -2, 0}, {4, 4, 0}},
                    {{0, 1, 2}, {3, 4, 5}})
                .find("2 pairs of border edges cross"),
            std::string::npos);
  // One on top of the other without touching.
  EXPECT_NE(refusal({{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {2, 2, 5}, {3, 2, 5}, {2, 3, 5}},
                    {{0, 1, 2}, {3, 4, 5}})
                .find("1 piece is covered more than once"),
            std::string::npos);
}

TEST(TinSource, WeldsVerticesOfOneHeightAndDropsUnusedOnes) {
  const TinTerrain terrain =
      read({{0, 0, 1}, {4, 0, 2}, {0, 4, 3}, {4, 0, 2}, {4, 4, 5}, {0, 4, 3}, {99, 99, 99}},
           {{0, 1, 2}, {3, 4, 5}});
  expect_sound(terrain, 2, 0);
  EXPECT_EQ(terrain.tin.vertices.size(), 4U);
  EXPECT_EQ(terrain.merged_vertices, 2U);
  EXPECT_EQ(terrain.unused_vertices, 1U);
}

TEST(TinSource, LeavesOutTrianglesOfNoHeight) {
  SourceOptions options;
  options.nodata = 3.0;
  std::vector<Vertex3> vertices = kSquare;
  vertices.push_back({20, -5, 7});
  const TinTerrain terrain = read(vertices, {{0, 1, 2}, {0, 2, 3}, {0, 4, 1}, {0, 1, 3}}, options);
  EXPECT_EQ(terrain.left_out_triangles, 2U);
}

TEST(TinSource, KeepsWhatDigitsTheGridHoldsAndFlipsSpoiledSlivers) {
  // A fan of slivers finer than the grid along one side of a square of 300 units.
  std::vector<Vertex3> vertices = {{0, 0, 0}, {300, 0, 0}, {300, 300, 0}, {0, 300, 0}};
  vertices.push_back({100.12345600123, 0.00000000017, 1});
  vertices.push_back({200.00000000456, 0.00000000031, 2});
  const std::vector<Face> faces = {{0, 1, 5}, {0, 5, 4}, {0, 4, 3},
                                   {4, 5, 3}, {5, 2, 3}, {5, 1, 2}};
  const TinTerrain terrain = read(vertices, faces);
  EXPECT_EQ(validate(terrain.tin), "");
  EXPECT_EQ(terrain.frame.map.step_x, 1e-6);
  EXPECT_GT(terrain.largest_shift_plan, 0.0);
  EXPECT_LT(terrain.largest_shift_plan, 1e-6);
  EXPECT_GE(terrain.mended_triangles, 2U);
  EXPECT_EQ(triangles_of(terrain.tin, TriangleClass::kVoid).size(), 0U);
  EXPECT_EQ(terrain.tin.vertices.size(), 6U);
}

TEST(TinSource, MendsNoMoreSliversThanFitIntoTheMemory) {
  // Two slivers, one of them with many triangles around a corner.
  std::vector<Vertex3> vertices = {{0, 0, 0}, {300, 0, 0}, {300, 300, 0}, {0, 300, 0}};
  vertices.push_back({100.12345600123, 0.00000000017, 1});
  vertices.push_back({200.00000000456, 0.00000000031, 2});
  std::vector<Face> faces = {{0, 1, 5}, {0, 5, 4}, {0, 4, 3}, {4, 5, 3}, {5, 2, 3}, {5, 1, 2}};
  for (int y = 0; y <= 300; ++y) {
    vertices.push_back({600, double(y), 0});
    faces.push_back({1, 6 + y, y < 300 ? 7 + y : 2});
  }
  const TestFile file(".obj", obj_of(vertices, faces));
  EXPECT_GE(triangles_in(file.path()).counts().mended_triangles, 2U);
  try {
    static_cast<void>(triangles_in(file.path(), {}, 1));
    FAIL() << "mended";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource_exhausted);
    EXPECT_NE(e.message().find("which take 1M of memory"), std::string::npos) << e.message();
    EXPECT_NE(e.message().find("--memory"), std::string::npos) << e.message();
    EXPECT_EQ(e.context(), file.path());
  }
}

/// Every triangle is in one part.
void expect_parts_are_the_whole(const TinTriangles& triangles, const Tin& whole,
                                std::uint64_t parts) {
  for (const TriangleClass wanted : {TriangleClass::kSurface, TriangleClass::kVoid}) {
    std::set<KeyTriangle> all;
    for (std::uint64_t i = 0; i < parts; ++i) {
      for (const KeyTriangle& t : triangles_of(triangles.part(i, parts), wanted)) {
        EXPECT_TRUE(all.insert(t).second);
      }
    }
    EXPECT_TRUE(all == triangles_of(whole, wanted)) << parts << " parts";
  }
}

/// Triangulations of random points with triangles taken out at random, against the definition.
TEST(TinSource, FillsRandomHolesExactly) {
  std::mt19937 random(11);
  for (int round = 0; round < 60; ++round) {
    const int side = 3 + static_cast<int>(random() % 40);
    std::map<VertexKey, HeightBits> points;
    const int count = 4 + static_cast<int>(random() % 150);
    for (int i = 0; i < count; ++i) {
      const GridPoint p{static_cast<std::int32_t>(random() % side),
                        static_cast<std::int32_t>(random() % side)};
      points[key_of(p)] = static_cast<HeightBits>(random() % 100);
    }
    std::vector<GridPoint> positions;
    std::vector<HeightBits> heights;
    for (const auto& [key, height] : points) {
      positions.push_back(point_of(key));
      heights.push_back(height);
    }
    Tin full;
    try {
      full = make_delaunay_tin(positions, heights);
    } catch (const Error&) {
      continue;  // collinear
    }
    std::vector<Vertex3> vertices;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      vertices.push_back({double(positions[i].x), double(positions[i].y), double(heights[i])});
    }
    std::vector<Face> faces;
    std::set<KeyTriangle> kept;
    const auto share = random() % 10;
    for (const Triangle& t : full.triangles) {
      if (random() % 10 < share) continue;
      faces.push_back({int(t.v[0]), int(t.v[1]), int(t.v[2])});
    }
    if (faces.empty()) continue;
    std::shuffle(faces.begin(), faces.end(), random);
    const TestFile file(".obj", obj_of(vertices, faces));
    const TinTriangles triangles = triangles_in(file.path());
    const TinTerrain terrain = triangles;
    EXPECT_EQ(validate(terrain.tin), "");
    expect_parts_are_the_whole(triangles, terrain.tin, 1 + random() % 20);
    const auto surface = triangles_of(terrain.tin, TriangleClass::kSurface);
    EXPECT_EQ(surface.size(), faces.size());
    const MapPoint origin = terrain.frame.map.to_map(0, 0);
    for (const Face& f : faces) {
      KeyTriangle keys{};
      for (std::size_t i = 0; i < 3; ++i) {
        const GridPoint p = positions[static_cast<std::size_t>(f[i])];
        keys[i] = key_of(
            {p.x - static_cast<std::int32_t>(origin.x), p.y - static_cast<std::int32_t>(origin.y)});
      }
      std::rotate(keys.begin(), std::min_element(keys.begin(), keys.end()), keys.end());
      EXPECT_TRUE(surface.contains(keys));
    }
  }
}

TEST(TinSource, RefusesABoxAndABorderThatDoesNotFit) {
  SourceOptions options;
  options.bbox = {0, 0, 1, 1};
  EXPECT_THROW(static_cast<void>(read(kSquare, kTwo, options)), Error);
  std::vector<Vertex3> vertices;
  std::vector<Face> faces;
  for (int i = 0; i < 3000; ++i) {
    const double x = 2.0 * (i % 60), y = 2.0 * (i / 60);
    const int n = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), {{x, y, 0}, {x + 1, y, 0}, {x, y + 1, 0}});
    faces.push_back({n, n + 1, n + 2});
  }
  const TestFile file(".obj", obj_of(vertices, faces));
  try {
    static_cast<void>(triangles_in(file.path(), {}, 1'000'000));
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource_exhausted);
    EXPECT_NE(e.message().find("has 9000 edges, which take 3M"), std::string::npos) << e.message();
    EXPECT_NE(e.message().find("--memory"), std::string::npos);
  }
}

/// A strip upwards with teeth on both sides; its border has as many edges as it has vertices.
TestFile strip_of(std::uint64_t border) {
  std::vector<Vertex3> vertices;
  std::vector<Face> faces;
  for (int i = 0; i < static_cast<int>(border); ++i) {
    const double tooth = i / 2 % 2;
    vertices.push_back({i % 2 == 0 ? tooth : 10.0 + tooth, static_cast<double>(i), 0.0});
    if (i >= 2) {
      faces.push_back(i % 2 == 0 ? Face{i - 2, i - 1, i} : Face{i - 2, i, i - 1});
    }
  }
  return {".obj", obj_of(vertices, faces)};
}

/// Twice the area of a polygon.
std::int64_t area_of(const std::vector<GridPoint>& corners) {
  std::int64_t sum = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += orient(corners[0], corners[i], corners[i + 1]);
  }
  return sum;
}

TEST(TinSource, FillsBordersOfEverySizeWhateverTheMemory) {
  constexpr std::uint64_t kMost = TinTriangles::kMostBorderInMemory;
  constexpr std::uint64_t kEnough = kMost * TinTriangles::kBytesOfBorderEdge;
  for (const std::uint64_t border : test::some_of({kMost - 1, kMost, kMost + 1, kMost + 2})) {
    SCOPED_TRACE(border);
    const TestFile file = strip_of(border);
    const TinTriangles triangles = triangles_in(file.path(), {}, kEnough);
    const Tin tin = triangles.part(0, 1);
    ASSERT_EQ(validate(tin), "");
    std::int64_t area = 0;
    for (const Triangle& t : tin.triangles) {
      area += orient(tin.position(t.v[0]), tin.position(t.v[1]), tin.position(t.v[2]));
    }
    EXPECT_EQ(area, area_of(triangles.hull().corners()));
    EXPECT_GT(triangles.counts().void_triangles, border / 3);
    if (border > kMost) {
      const Tin small = triangles_in(file.path(), {}, 4 << 20).part(0, 1);
      EXPECT_TRUE(triangles_of(small, TriangleClass::kVoid) ==
                  triangles_of(tin, TriangleClass::kVoid));
    }
  }
  // Half of the least memory that a build takes is enough.
  EXPECT_LE(kEnough, std::uint64_t{20} << 20);
}

/// The border of what is not left out, swept over: fills the hull as exactly.
void expect_swept_to_a_convex_tin(const Tin& whole) {
  const ExternalMemory memory{FileLayer::system(), std::filesystem::temp_directory_path()};
  const auto vertex = [&](VertexId v) {
    return GridVertex{whole.position(v), static_cast<double>(whole.vertices[v].height)};
  };
  RecordFile<GridEdge> border(memory, "border");
  Tin swept;
  swept.vertices = whole.vertices;
  swept.has_height = whole.has_height;
  const auto put = [&](const std::array<VertexId, 3>& v, TriangleClass c) {
    swept.triangles.push_back({{v[0], v[1], v[2]}, {kNone, kNone, kNone}});
    swept.classes.push_back(c);
  };
  for (TriangleId t = 0; t < whole.triangles.size(); ++t) {
    if (whole.classes[t] != TriangleClass::kSurface) continue;
    const Triangle& triangle = whole.triangles[t];
    put({triangle.v[0], triangle.v[1], triangle.v[2]}, TriangleClass::kSurface);
    for (int i = 0; i < 3; ++i) {
      const TriangleId n = triangle.n[i];
      if (n == kNone || whole.classes[n] != TriangleClass::kSurface) {
        border.add({vertex(triangle.v[next_corner(i)]), vertex(triangle.v[previous_corner(i)])});
      }
    }
  }
  border.finish();
  TinFaults faults;
  const auto number = [&](const GridVertex& v) {
    const auto at =
        std::lower_bound(whole.vertices.begin(), whole.vertices.end(), key_of(v.position),
                         [](const Vertex& a, VertexKey key) { return key_of(a.position) < key; });
    EXPECT_EQ(v.height, static_cast<double>(at->height));
    return static_cast<VertexId>(at - whole.vertices.begin());
  };
  sweep_voids(
      border, memory,
      [&](const std::array<GridVertex, 3>& c) {
        put({number(c[0]), number(c[1]), number(c[2])}, TriangleClass::kVoid);
      },
      faults, "swept");
  faults.refuse({}, "swept");
  for (Vertex& v : swept.vertices) v.triangle = kNone;
  link_tin(swept);
  EXPECT_EQ(validate(swept), "");
}

TEST(TinSource, SweepsOverRandomHoles) {
  std::mt19937 random(3);
  for (int round = 0; round < 300; ++round) {
    const int side = 3 + static_cast<int>(random() % 30);
    std::vector<GridPoint> positions;
    const int count = 4 + static_cast<int>(random() % 200);
    for (int i = 0; i < count; ++i) {
      positions.push_back(
          {static_cast<std::int32_t>(random() % side), static_cast<std::int32_t>(random() % side)});
    }
    std::sort(positions.begin(), positions.end(),
              [](GridPoint a, GridPoint b) { return key_of(a) < key_of(b); });
    positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
    const auto share = random() % 10;
    Tin full;
    try {
      full = make_delaunay_tin(positions, std::vector<HeightBits>(positions.size(), 7));
    } catch (const Error&) {
      continue;  // collinear
    }
    std::vector<Vertex3> vertices;
    for (const GridPoint p : positions) vertices.push_back({double(p.x), double(p.y), 0.0});
    std::vector<Face> faces;
    for (const Triangle& t : full.triangles) {
      if (random() % 10 >= share) faces.push_back({int(t.v[0]), int(t.v[1]), int(t.v[2])});
    }
    if (!faces.empty()) expect_swept_to_a_convex_tin(read(vertices, faces).tin);
  }
}

TEST(TinSource, SweepFindsFaults) {
  const auto fault_of = [](const std::vector<std::array<GridPoint, 3>>& triangles) -> std::string {
    const ExternalMemory memory{FileLayer::system(), std::filesystem::temp_directory_path()};
    RecordFile<GridEdge> border(memory, "border");
    for (const auto& t : triangles) {
      for (std::size_t i = 0; i < 3; ++i) border.add({{t[i], 0.0}, {t[(i + 1) % 3], 0.0}});
    }
    border.finish();
    TinFaults faults;
    sweep_voids(
        border, memory, [](const auto&) {}, faults, "here");
    return faults.t_junctions.count > 0 ? "T-junction"
           : faults.crossings.count > 0 ? "crossing"
           : faults.covered.count > 0   ? "covered"
                                        : "none";
  };
  using Three = std::array<GridPoint, 3>;
  const auto three = [](GridPoint a, GridPoint b, GridPoint c) { return Three{a, b, c}; };
  EXPECT_EQ(fault_of({three({0, 0}, {4, 0}, {0, 4}), three({4, 4}, {0, 5}, {5, 0})}), "none");
  EXPECT_EQ(fault_of({three({0, 4}, {8, 4}, {4, 9}), three({4, 4}, {3, 0}, {5, 0})}), "T-junction");
  EXPECT_EQ(fault_of({three({0, 1}, {8, 1}, {4, 9}), three({3, 0}, {5, 0}, {4, 4})}), "crossing");
  EXPECT_EQ(fault_of({three({0, 0}, {9, 0}, {0, 9}), three({2, 2}, {3, 2}, {2, 3})}), "covered");
}

TEST(TinSource, NamesVerticesThatAreNotThereOrTwice) {
  EXPECT_EQ(refusal(kSquare, {{0, 1, 2}, {0, 2, 7}}),
            "triangle 1 names vertex 7, which is not there");
  const TestFile file(".2dm",
                      "MESH2D\nND 5 0 0 0\nND -3 9 0 1\nE3T 1 5 -3 8 1\nND 8 9 9 2\nND 5 1 1 1\n");
  try {
    static_cast<void>(triangles_in(file.path()));
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.message(), "two vertices have the id 5");
  }
}

}  // namespace
}  // namespace ptin
