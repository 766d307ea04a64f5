// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/link.h"

#include <gtest/gtest.h>

#include "engine/mesh/validate.h"
#include "tests/mesh/drawn.h"

namespace ptin {
namespace {

using drawn::Drawing;

TEST(Link, FindsNeighboursAndTrianglesOfVerticesAgain) {
  const Drawing d = drawn::draw({"D...E...C", "....U....", "A...F...B"},
                                {"AFU", "FBU", "BCU", "CEU.", "EDU", "DAU"});
  Tin tin = d.tin;
  for (Triangle& t : tin.triangles) t.n[0] = t.n[1] = t.n[2] = kNone;
  for (Vertex& v : tin.vertices) v.triangle = kNone;
  link_tin(tin);
  EXPECT_EQ(validate(tin), "");
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(tin.triangles[t].n[i], d.tin.triangles[t].n[i]);
  }
}

TEST(Link, OfTrianglesOnOneSideOfAnEdgeMakesAMeshThatIsRefused) {
  Drawing d = drawn::draw({"D.....C", "...U...", "A.....B"}, {"ABU", "BCU", "CDU", "DAU"});
  d.tin.triangles.push_back(d.tin.triangles[0]);  // twice
  d.tin.classes.push_back(d.tin.classes[0]);
  for (Triangle& t : d.tin.triangles) t.n[0] = t.n[1] = t.n[2] = kNone;
  link_tin(d.tin);
  EXPECT_NE(validate(d.tin), "");
}

}  // namespace
}  // namespace ptin
