// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which vertices of a TIN decide its grid: those of triangles that are kept.
#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/tin/tin_source.h"
#include "engine/construct/tin/tin_vertices.h"
#include "tests/construct/tin/tin_fixture.h"

namespace ptin {
namespace {

using namespace tin_test;

/// The grid's steps, and how heights are kept.
struct GridFacts {
  explicit GridFacts(const TerrainFrame& frame)
      : map(frame.map), heights(frame.heights), rounding(frame.height_rounding) {}
  bool operator==(const GridFacts&) const = default;
  AffineMap map;
  HeightEncoding heights;
  double rounding;
};

const std::vector<Vertex3> kUtmSquare = {{500000.000001, 5000000.25, 1.25},
                                         {500010.5, 5000000.25, 2.5},
                                         {500010.5, 5000010.75, 3.75},
                                         {500000.000001, 5000010.75, 4.25}};

TEST(TinGrid, ChoosesItsGridByVerticesOfTrianglesAlone) {
  const GridFacts clean(read(kUtmSquare, kTwo).frame);
  EXPECT_EQ(clean.map.step_x, 1e-6);
  std::vector<Vertex3> vertices = kUtmSquare;
  vertices.push_back({0, 0, -1234.000001});
  EXPECT_TRUE(GridFacts(read(vertices, kTwo).frame) == clean);
  SourceOptions coarse;
  coarse.resolution = 0.001;
  EXPECT_EQ(read(vertices, kTwo, coarse).vertices, 4U);
}

TEST(TinGrid, ChoosesItsGridWithoutTrianglesOfNoHeight) {
  const GridFacts clean(read(kUtmSquare, kTwo).frame);
  SourceOptions options;
  options.nodata = -9999.123456789;
  std::vector<Vertex3> vertices = kUtmSquare;
  vertices.push_back({500020, 5000000, -9999.123456789});
  vertices.push_back({1, 1, 1.0000000001});  // of a triangle that is left out
  std::vector<Face> faces = kTwo;
  faces.push_back({1, 4, 5});
  const TinTerrain terrain = read(vertices, faces, options);
  EXPECT_TRUE(GridFacts(terrain.frame) == clean);
  EXPECT_EQ(terrain.left_out_triangles, 1U);
  EXPECT_EQ(terrain.unused_vertices, 2U);
  EXPECT_EQ(terrain.vertices, 4U);

  const TestFile file(".obj", obj_of(vertices, faces));
  TinVertices points(file.path(), {}, options.nodata);
  std::vector<SourcePoint> batch;
  ASSERT_TRUE(points.next(batch));
  ASSERT_EQ(batch.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(to_double(batch[i].x), kUtmSquare[i][0]);  // to the last digit
  }
}

/// Against the definition: whatever triangles name vertices of no height, the rest is read as from
/// a file without them.
TEST(TinGrid, LeavesOutRandomTrianglesOfNoHeight) {
  std::mt19937 random(5);
  SourceOptions options;
  options.nodata = -1.0;
  for (int round = 0; round < 30; ++round) {
    const int side = 3 + static_cast<int>(random() % 6);
    std::vector<Vertex3> vertices;
    for (int v = 0; v < side * side; ++v) {
      vertices.push_back({double(v % side), double(v / side), random() % 8 == 0 ? -1.0 : v % 5});
    }
    std::vector<Face> faces, kept;
    for (int v = 0; v < side * (side - 1); ++v) {
      if (v % side == side - 1) continue;
      for (const Face& f : {Face{v, v + 1, v + side + 1}, Face{v, v + side + 1, v + side}}) {
        faces.push_back(f);
        const auto is_given = [&](int c) { return vertices[std::size_t(c)][2] >= 0.0; };
        if (std::all_of(f.begin(), f.end(), is_given)) kept.push_back(f);
      }
    }
    if (kept.empty()) continue;
    std::shuffle(faces.begin(), faces.end(), random);
    std::set<int> used;
    for (const Face& f : kept) used.insert(f.begin(), f.end());
    const TinTerrain all = read(vertices, faces, options), some = read(vertices, kept);
    EXPECT_EQ(all.left_out_triangles, faces.size() - kept.size());
    EXPECT_EQ(all.unused_vertices, vertices.size() - used.size());
    EXPECT_TRUE(GridFacts(all.frame) == GridFacts(some.frame));
    for (const TriangleClass wanted : {TriangleClass::kSurface, TriangleClass::kVoid}) {
      EXPECT_TRUE(triangles_of(all.tin, wanted) == triangles_of(some.tin, wanted));
    }
  }
}

/// Against the definition, with memory for some of them and for all.
TEST(TinVertices, AreTheSameInAnyMemory) {
  std::mt19937 random(8);
  constexpr int kSide = 150;
  std::vector<int> ids(kSide * kSide);
  std::iota(ids.begin(), ids.end(), 0);
  std::shuffle(ids.begin(), ids.end(), random);
  std::vector<Vertex3> vertices(ids.size());
  for (int v = 0; v < kSide * kSide; ++v) {
    const double z = random() % 50 == 0 ? -1.0 : double(random() % 100);
    vertices[std::size_t(ids[std::size_t(v)])] = {0.25 * (v % kSide), 0.5 * (v / kSide), z};
  }
  std::vector<Face> faces;
  std::set<int> used;
  for (int v = 0; v < kSide * (kSide - 1); ++v) {
    if (v % kSide == kSide - 1 || random() % 2 == 0) continue;
    const auto id = [&](int n) { return ids[std::size_t(n)]; };
    faces.push_back({id(v), id(v + 1), id(v + kSide)});
    if (std::all_of(faces.back().begin(), faces.back().end(),
                    [&](int c) { return vertices[std::size_t(c)][2] >= 0.0; })) {
      used.insert(faces.back().begin(), faces.back().end());
    }
  }
  const TestFile file(".obj", obj_of(vertices, faces));
  for (const std::uint64_t bytes : {std::uint64_t{1}, std::uint64_t{1} << 26}) {
    const ExternalMemory memory{FileLayer::system(),
                                std::filesystem::temp_directory_path().string(), bytes};
    TinVertices points(file.path(), {}, -1.0, {&memory, {}, {}});
    EXPECT_EQ(points.total(), used.size());
    EXPECT_EQ(points.left_out().total(), vertices.size() - used.size());
    auto next = used.begin();
    for (std::vector<SourcePoint> batch; points.next(batch);) {
      for (const SourcePoint& p : batch) {
        ASSERT_NE(next, used.end());
        const Vertex3& v = vertices[std::size_t(*next++)];
        EXPECT_EQ(to_double(p.x), v[0]);
        EXPECT_EQ(to_double(p.y), v[1]);
        EXPECT_EQ(to_double(p.z), v[2]);
      }
    }
    EXPECT_EQ(next, used.end());
  }
}

TEST(TinVertices, AreThoseThatTrianglesUse) {
  std::vector<Vertex3> vertices = kSquare;
  vertices.push_back({50, 50, 50});
  const TestFile file(".obj", obj_of(vertices, kTwo));
  TinVertices points(file.path(), {});
  std::vector<SourcePoint> batch;
  ASSERT_TRUE(points.next(batch));
  EXPECT_EQ(batch.size(), 4U);
  EXPECT_EQ(points.left_out().total(), 1U);
  EXPECT_FALSE(points.next(batch));
}

}  // namespace
}  // namespace ptin
