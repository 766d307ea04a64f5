// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/compact.h"

#include <gtest/gtest.h>

#include "engine/mesh/collapse.h"
#include "engine/mesh/star.h"
#include "engine/mesh/validate.h"
#include "tests/mesh/drawn.h"

namespace ptin {
namespace {

using drawn::Drawing;

/// U and V inside of a square, and what is left when U was collapsed into V.
Drawing collapsed() {
  Drawing d = drawn::draw({"D.......C", ".........", "..U...V..", ".........", "A.......B"},
                          {"ABU", "BVU", "BCV", "CDV.", "DUV", "DAU"});
  Star star;
  walk_star(d.tin, d.at('U'), star);
  std::size_t j = 0;
  while (star.link[j] != d.at('V')) ++j;
  collapse(d.tin, star, j);
  return d;
}

TEST(Compact, LeavesWhatIsAliveInItsOrder) {
  const Drawing before = collapsed();
  Tin tin = before.tin;
  std::vector<TriangleId> former_triangles(tin.triangles.size());
  std::vector<VertexId> former_vertices(tin.vertices.size());
  for (TriangleId t = 0; t < former_triangles.size(); ++t) former_triangles[t] = t;
  for (VertexId v = 0; v < former_vertices.size(); ++v) former_vertices[v] = v;
  keep_numbered(compact_triangles(tin), former_triangles);
  keep_numbered(compact_vertices(tin), former_vertices);
  EXPECT_EQ(validate(tin), "");
  EXPECT_EQ(tin.triangles.size(), before.tin.alive_triangles());
  EXPECT_EQ(tin.vertices.size(), before.tin.alive_vertices());
  EXPECT_LT(tin.triangles.size(), before.tin.triangles.size());
  ASSERT_EQ(former_triangles.size(), tin.triangles.size());
  ASSERT_EQ(former_vertices.size(), tin.vertices.size());
  for (VertexId v = 0; v < former_vertices.size(); ++v) {
    EXPECT_TRUE(v == 0 || former_vertices[v - 1] < former_vertices[v]);
    EXPECT_EQ(tin.position(v), before.tin.position(former_vertices[v]));
    EXPECT_EQ(tin.has_height[v], before.tin.has_height[former_vertices[v]]);
  }
  for (TriangleId t = 0; t < former_triangles.size(); ++t) {
    EXPECT_TRUE(t == 0 || former_triangles[t - 1] < former_triangles[t]);
    EXPECT_EQ(tin.classes[t], before.tin.classes[former_triangles[t]]);
    for (int i = 0; i < 3; ++i) {
      const Triangle& was = before.tin.triangles[former_triangles[t]];
      EXPECT_EQ(former_vertices[tin.triangles[t].v[i]], was.v[i]);
      const TriangleId n = tin.triangles[t].n[i];
      EXPECT_EQ(n == kNone ? kNone : former_triangles[n], was.n[i]);
    }
  }
}

TEST(Compact, TakesTrianglesOutOfAMesh) {
  Drawing d = drawn::draw({"D.....C", "...U...", "A.....B"}, {"ABU", "BCU", "CDU", "DAU"});
  Tin& tin = d.tin;
  tin.triangles[d.triangle("ABU")].v[0] = kNone;
  tin.triangles[d.triangle("BCU")].v[0] = kNone;
  compact_triangles(tin);
  point_vertices(tin);
  const VertexId gone = d.at('B');
  const Renumbering vertices = compact_vertices(tin);
  EXPECT_EQ(vertices[gone], kNone);
  ASSERT_EQ(tin.triangles.size(), 2U);
  EXPECT_EQ(tin.vertices.size(), 4U);
  int open = 0;
  for (const Triangle& t : tin.triangles) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(t.v[i], 4U);
      open += t.n[i] == kNone ? 1 : 0;
    }
  }
  EXPECT_EQ(open, 4) << "neighbours that went are still named";
}

}  // namespace
}  // namespace ptin
