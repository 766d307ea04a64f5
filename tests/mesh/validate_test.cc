// SPDX-License-Identifier: GPL-3.0-or-later
//
// validate() names each invariant that is broken: every one is broken here in turn.
#include "engine/mesh/validate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "engine/mesh/link.h"
#include "tests/mesh/drawn.h"

namespace ptin {
namespace {

using drawn::Drawing;

Drawing valid() {
  return drawn::draw({"D.....C", "...U...", "A.....B"}, {"ABU", "BCU", "CDU", "DAU"});
}

/// The first two characters of what is said of a mesh after `damage`.
std::string fault_after(const std::function<void(Drawing&)>& damage) {
  Drawing d = valid();
  damage(d);
  return validate(d.tin).substr(0, 2);
}

TEST(Validate, FindsNothingInAValidMesh) {
  EXPECT_EQ(validate(valid().tin), "");
  EXPECT_EQ(twice_area(valid().tin), 2 * 6 * 2);
}

TEST(Validate, I1NamesATriangleTurnedOver) {
  EXPECT_EQ(fault_after([](Drawing& d) {
              d.tin.vertices[d.at('U')].position = {3, -1};
            }),
            "I1")
      << "off the grid";
  EXPECT_EQ(fault_after([](Drawing& d) {
              d.tin.vertices[d.at('U')].position = {3, 9};
            }),
            "I1")
      << "outside of its star";
  EXPECT_EQ(fault_after([](Drawing& d) {
              d.tin.vertices[d.at('U')].position = {3, 0};
            }),
            "I1")
      << "flat";
}

TEST(Validate, I1NamesCornersThatAreNotThere) {
  EXPECT_EQ(fault_after([](Drawing& d) { d.tin.triangles[0].v[1] = 99; }), "I1");
  EXPECT_EQ(fault_after([](Drawing& d) { d.tin.vertices[d.at('U')].triangle = kNone; }), "I1");
  EXPECT_EQ(fault_after(
                [](Drawing& d) { d.tin.vertices[d.at('B')].position = d.tin.position(d.at('A')); }),
            "I1");
  EXPECT_EQ(fault_after([](Drawing& d) { d.tin.classes.pop_back(); }), "I1");
  EXPECT_EQ(fault_after([](Drawing& d) { d.tin.has_height.pop_back(); }), "I1");
}

TEST(Validate, I2NamesNeighboursThatDoNotAgree) {
  EXPECT_EQ(fault_after([](Drawing& d) {
              Triangle& t = d.tin.triangles[d.triangle("ABU")];
              *std::find(t.n, t.n + 3, d.triangle("BCU")) = d.triangle("CDU");
            }),
            "I2");
  EXPECT_EQ(fault_after([](Drawing& d) {
              Triangle& t = d.tin.triangles[d.triangle("ABU")];
              *std::find(t.n, t.n + 3, kNone) = 77;
            }),
            "I2");
}

TEST(Validate, I2NamesANeighbourMissingOnOneSideAlone) {
  EXPECT_EQ(fault_after([](Drawing& d) {
              Triangle& t = d.tin.triangles[d.triangle("ABU")];
              *std::find(t.n, t.n + 3, d.triangle("BCU")) = kNone;
            }),
            "I2");
}

TEST(Validate, I3NamesAVertexThatStandsInNoTriangle) {
  // Areas cannot tell: with I2 they always add up to what the border has inside.
  EXPECT_EQ(fault_after([](Drawing& d) {
              d.tin.vertices.push_back({{1, 1}, 0, d.triangle("ABU")});
              d.tin.has_height.push_back(1);
            }),
            "I3");
}

TEST(Validate, I4NamesAStarThatGoesRoundTwice) {
  // Every triangle around U is counter-clockwise and has its neighbours, but the star winds twice:
  // a disk that covers its middle doubly. Areas and V - E + F do not tell.
  Drawing d = drawn::draw(
      {"..d...c..", "D.......C", ".........", "....U....", ".........", "A.......B", "..a...b.."},
      {"ABU", "BCU", "CDU", "DaU", "abU", "bcU", "cdU", "dAU"});
  std::fill(d.tin.classes.begin(), d.tin.classes.end(), TriangleClass::kVoid);
  EXPECT_EQ(validate(d.tin).substr(0, 2), "I4") << validate(d.tin);
}

/// Half of the grid's side: what lies around its middle has areas near the largest.
constexpr int kMiddle = 1 << 29;

/// Adds a vertex around the middle of the grid, with a height.
void add_around_middle(Tin& tin, double radius, double degrees) {
  const double angle = degrees / 180 * std::acos(-1.0);
  tin.vertices.push_back({{static_cast<int>(std::lround(kMiddle + radius * std::cos(angle))),
                           static_cast<int>(std::lround(kMiddle + radius * std::sin(angle)))},
                          0,
                          kNone});
  tin.has_height.push_back(1);
}

void add_surface_triangle(Tin& tin, VertexId a, VertexId b, VertexId c) {
  tin.triangles.push_back({{a, b, c}, {kNone, kNone, kNone}});
  tin.classes.push_back(TriangleClass::kSurface);
}

// The areas of the two meshes below add up to more than 64 bits hold: they must not be added up
// before the border is known to go round once. The undefined sanitizer would tell.
TEST(Validate, I4NamesALargeStarThatGoesRoundManyTimes) {
  constexpr std::uint32_t kRim = 40;
  Tin tin;
  for (std::uint32_t i = 0; i < kRim; ++i) {
    add_around_middle(tin, 5.3e8, 81.0 * i);  // nine times round, at every multiple of 9 degrees
  }
  add_around_middle(tin, 0, 0);
  for (std::uint32_t i = 0; i < kRim; ++i) {
    add_surface_triangle(tin, kRim, i, (i + 1) % kRim);
  }
  link_tin(tin);
  EXPECT_EQ(validate(tin), "I4: the border goes round 9 times");
}

TEST(Validate, I4NamesALargeSpiral) {
  constexpr std::uint32_t kSteps = 8 * 8;  // eight times round
  Tin tin;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    add_around_middle(tin, 1e6 + 1000.0 * i, 45.0 * i);
    add_around_middle(tin, 5.3e8 - 1000.0 * i, 45.0 * i);
  }
  for (VertexId v = 0; v < 2 * kSteps; v += 2) {
    add_surface_triangle(tin, v, v + 1, v + 3);
    add_surface_triangle(tin, v, v + 3, v + 2);
  }
  link_tin(tin);
  EXPECT_EQ(validate(tin).substr(0, 2), "I4") << validate(tin);
}

TEST(Validate, TakesADomainAsLargeAsTheGrid) {
  Tin tin;
  for (const GridPoint p : {GridPoint{0, 0}, {kGridMax, 0}, {kGridMax, kGridMax}, {0, kGridMax}}) {
    tin.vertices.push_back({p, 0, kNone});
    tin.has_height.push_back(1);
  }
  add_surface_triangle(tin, 0, 1, 2);
  add_surface_triangle(tin, 0, 2, 3);
  link_tin(tin);
  EXPECT_EQ(validate(tin), "");
  EXPECT_EQ(twice_area(tin), std::int64_t{1} << 61);
}

TEST(Validate, I4NamesADomainThatIsNotConvex) {
  const Drawing d = drawn::draw({"D.....C", "...U...", "A.....B"}, {"ABU", "CDU", "DAU"});
  EXPECT_EQ(validate(d.tin).substr(0, 2), "I4");
}

TEST(Validate, I4NamesPiecesThatAreNotConnected) {
  const Drawing d = drawn::draw({"D..C...G", "........", "A..B..EF"}, {"ABC", "ACD", "EFG"});
  EXPECT_EQ(validate(d.tin).substr(0, 2), "I4") << "two borders";
}

TEST(Validate, I4NamesAHole) {
  const Drawing d = drawn::draw({"D.......C", "...G.H...", "...E.F...", "A.......B"},
                                {"ABF", "AFE", "BCH", "BHF", "CDG", "CGH", "DAE", "DEG"});
  EXPECT_EQ(validate(d.tin).substr(0, 2), "I4");
}

TEST(Validate, I4NamesAVertexWhereTwoBordersMeet) {
  const Drawing d = drawn::draw({"A...B", "..X..", "C...D"}, {"ACX", "BXD"});
  EXPECT_EQ(validate(d.tin).substr(0, 2), "I4");
}

TEST(Validate, I4WantsABorder) { EXPECT_EQ(validate(Tin{}).substr(0, 2), "I4"); }

TEST(Validate, I5NamesASurfaceTriangleWithACornerWithoutHeight) {
  EXPECT_EQ(fault_after([](Drawing& d) { d.tin.has_height[d.at('U')] = 0; }), "I5");
  EXPECT_EQ(fault_after([](Drawing& d) {
              d.tin.has_height[d.at('U')] = 0;
              std::fill(d.tin.classes.begin(), d.tin.classes.end(), TriangleClass::kVoid);
            }),
            "");
}

TEST(Validate, I6NamesAVertexThatPointsToAForeignTriangle) {
  EXPECT_EQ(fault_after([](Drawing& d) { d.tin.vertices[d.at('A')].triangle = d.triangle("BCU"); }),
            "I6");
  EXPECT_EQ(fault_after([](Drawing& d) { d.tin.vertices[d.at('A')].triangle = 1000; }), "I6");
}

TEST(Validate, I6WantsTheFirstTriangleOfTheWalkOnTheBorder) {
  EXPECT_EQ(fault_after([](Drawing& d) { d.tin.vertices[d.at('A')].triangle = d.triangle("DAU"); }),
            "I6");
  EXPECT_EQ(fault_after([](Drawing& d) { d.tin.vertices[d.at('A')].triangle = d.triangle("ABU"); }),
            "");
}

}  // namespace
}  // namespace ptin
