// SPDX-License-Identifier: GPL-3.0-or-later
//
// Half-edge collapse and vertex split: drawn cases, and the round trip on random meshes.
#include <algorithm>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/mesh/collapse.h"
#include "engine/mesh/split.h"
#include "engine/mesh/star.h"
#include "engine/mesh/validate.h"
#include "tests/mesh/drawn.h"

namespace ptin {
namespace {

using drawn::draw;
using drawn::Drawing;

/// An inner vertex U of degree 4 and one of degree 3, X, in a square.
Drawing square() {
  return draw({"D.....C", ".......", "...U...", ".......", ".......", "...X...", "A.....B"},
              {"ABX", "BUX", "AUX", "BCU", "CDU", "DAU"});
}

Star star_of(const Drawing& d, char letter) {
  Star star;
  walk_star(d.tin, d.at(letter), star);
  return star;
}

std::string link_of(const Drawing& d, const Star& star) {
  std::string link;
  for (const VertexId v : star.link) {
    link += d.letters[v];
  }
  return link;
}

std::size_t place(const Drawing& d, const Star& star, char letter) {
  return link_of(d, star).find(letter);
}

/// The split that undoes a collapse which is already made: classes of removed triangles stay
/// readable.
SplitSite undo(const Drawing& d, const CollapseSite& s) {
  const auto class_of = [&](TriangleId t) {
    return t == kNone ? TriangleClass::kSurface : d.tin.classes[t];
  };
  return {
      s.u, s.w, s.vl, s.vr, s.left != kNone, s.right != kNone, class_of(s.left), class_of(s.right)};
}

TEST(WalkStar, GoesRoundAnInnerVertexCounterClockwise) {
  const Drawing d = square();
  ASSERT_EQ(validate(d.tin), "");
  const Star star = star_of(d, 'U');
  EXPECT_TRUE(star.closed);
  std::string link = link_of(d, star);
  std::rotate(link.begin(), std::min_element(link.begin(), link.end()), link.end());
  EXPECT_EQ(link, "AXBCD");
}

TEST(WalkStar, GoesAlongTheBorderFromTheNextVertexToThePreviousOne) {
  const Drawing d = square();
  const Star star = star_of(d, 'A');
  EXPECT_FALSE(star.closed);
  EXPECT_EQ(link_of(d, star), "BXUD");
  EXPECT_EQ(star.triangles.size(), 3u);
}

TEST(Collapse, OfDegreeThreeLeavesOneTriangleWhicheverNeighbourStays) {
  for (const char w : {'A', 'B', 'U'}) {
    Drawing d = square();
    const Star star = star_of(d, 'X');
    const std::size_t j = place(d, star, w);
    ASSERT_TRUE(can_collapse(d.tin, star, j));
    collapse(d.tin, star, j);
    EXPECT_EQ(validate(d.tin), "");
    EXPECT_EQ(d.triangles(), "ABU AUD BCU CDU");
  }
}

TEST(Collapse, IsRefusedWhereTheFanWouldFold) {
  // From A the fan of U would hold the triangle (A, X, B) turned over: X lies to the left of A -> B
  // as seen from U's star.
  Drawing d = draw({"D.....C", "......", ".X.U..", "......", "A.....B"},
                   {"AXD", "ABU", "AXU", "DXU", "BCU", "CDU"});
  ASSERT_EQ(validate(d.tin), "");
  const Star star = star_of(d, 'U');
  EXPECT_FALSE(can_collapse(d.tin, star, place(d, star, 'A')))
      << "the fan would hold A X D, flat or turned";
  EXPECT_TRUE(can_collapse(d.tin, star, place(d, star, 'X')));
}

TEST(Collapse, IsRefusedWhereAFanTriangleWouldBeFlat) {
  Drawing d = draw({"D..E..C", "...U...", "A.....B"}, {"ABU", "BCU", "CEU", "EDU", "DAU"});
  ASSERT_EQ(validate(d.tin), "");
  const Star star = star_of(d, 'U');
  EXPECT_FALSE(can_collapse(d.tin, star, place(d, star, 'C'))) << "C, E and D lie on one line";
  EXPECT_TRUE(can_collapse(d.tin, star, place(d, star, 'E')));
}

TEST(Collapse, OnTheBorderGoesAlongTheBorderAlone) {
  Drawing d = draw({"D.....C", ".......", "A..U..B"}, {"AUD", "UBC", "UCD"});
  ASSERT_EQ(validate(d.tin), "");
  const Star star = star_of(d, 'U');
  EXPECT_EQ(link_of(d, star), "BCDA");
  EXPECT_TRUE(can_collapse(d.tin, star, 0));
  EXPECT_FALSE(can_collapse(d.tin, star, 1));
  EXPECT_FALSE(can_collapse(d.tin, star, 2));
  EXPECT_TRUE(can_collapse(d.tin, star, 3));
  for (const char w : {'A', 'B'}) {
    Drawing copy = d;
    const CollapseSite site = collapse(copy.tin, star, place(d, star, w));
    EXPECT_EQ(validate(copy.tin), "");
    EXPECT_EQ(copy.triangles(), w == 'A' ? "ABC ACD" : "ABD BCD");
    EXPECT_EQ(site.left == kNone, w == 'A') << "one side has no triangle";
    EXPECT_EQ(site.right == kNone, w == 'B');
    const SplitResult back = split(copy.tin, undo(copy, site));
    EXPECT_TRUE(back.applied);
    EXPECT_EQ(validate(copy.tin), "");
    EXPECT_EQ(copy.triangles(), d.triangles());
  }
}

TEST(Collapse, LeavesCornersOfTheDomain) {
  const Drawing d = square();
  const Star star = star_of(d, 'A');
  for (std::size_t j = 0; j < star.degree(); ++j) {
    EXPECT_FALSE(can_collapse(d.tin, star, j));
  }
}

TEST(Collapse, KeepsTheClassesOfTheFan) {
  Drawing d = draw({"D.....C", ".......", "...u...", ".......", "A.....B"},
                   {"ABu.", "BCu.", "CDu.", "DAu."});
  ASSERT_EQ(validate(d.tin), "");
  const Star star = star_of(d, 'u');
  const CollapseSite site = collapse(d.tin, star, place(d, star, 'A'));
  EXPECT_EQ(d.triangles(), "ABC. ACD.");
  EXPECT_TRUE(split(d.tin, undo(d, site)).applied);
  EXPECT_EQ(d.triangles(), "ABu. AuD. BCu. CDu.");
}

TEST(Split, AppendsLeftThenRightAndChangesNothingElse) {
  Drawing d = square();
  const Tin before = d.tin;
  const Star star = star_of(d, 'U');
  const CollapseSite site = collapse(d.tin, star, place(d, star, 'C'));
  EXPECT_EQ(validate(d.tin), "");
  const SplitResult result = split(d.tin, undo(d, site));
  ASSERT_TRUE(result.applied);
  EXPECT_EQ(result.left, before.triangles.size());
  EXPECT_EQ(result.right, before.triangles.size() + 1);
  EXPECT_EQ(d.triangle("UCD"), result.left);
  EXPECT_EQ(d.triangle("UBC"), result.right);
  for (const char* kept : {"ABX", "BUX", "AUX", "DAU"}) {
    const TriangleId t = d.triangle(kept);
    EXPECT_LT(t, before.triangles.size());
    EXPECT_TRUE(
        std::is_permutation(before.triangles[t].v, before.triangles[t].v + 3, d.tin.triangles[t].v))
        << kept;
  }
}

TEST(SplitInto, TakesThePlacesItIsGivenAndFindsTheEndsByTheirKeys) {
  Drawing d = square();
  const std::string before = d.triangles();
  const Star star = star_of(d, 'U');
  const CollapseSite site = collapse(d.tin, star, place(d, star, 'C'));
  const std::size_t size = d.tin.triangles.size();
  const SplitSite wanted = undo(d, site);
  SplitSite found = wanted;
  found.vl = found.vr = kNone;
  const SplitEnds ends{key_of(d.tin.position(wanted.vl)), key_of(d.tin.position(wanted.vr))};
  ASSERT_TRUE(split_into(d.tin, found, ends, site.left, site.right));
  EXPECT_EQ(found.vl, wanted.vl);
  EXPECT_EQ(found.vr, wanted.vr);
  EXPECT_EQ(d.tin.triangles.size(), size);
  EXPECT_EQ(d.triangles(), before);
  EXPECT_EQ(validate(d.tin), "");
}

bool same(const Tin& a, const Tin& b) {
  return std::equal(a.triangles.begin(), a.triangles.end(), b.triangles.begin(), b.triangles.end(),
                    [](const Triangle& s, const Triangle& t) {
                      return std::equal(s.v, s.v + 3, t.v) && std::equal(s.n, s.n + 3, t.n);
                    }) &&
         std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(),
                    [](const Vertex& s, const Vertex& t) {
                      return s.triangle == t.triangle && s.position == t.position;
                    });
}

TEST(Split, RefusesWhatDoesNotFitAndLeavesTheMeshAsItWas) {
  Drawing d = square();
  const Star star = star_of(d, 'U');
  const CollapseSite site = collapse(d.tin, star, place(d, star, 'C'));
  const SplitSite good = undo(d, site);
  const Tin before = d.tin;
  const auto refused = [&](const SplitSite& s) {
    return !split(d.tin, s).applied && same(d.tin, before);
  };
  SplitSite s = good;
  std::swap(s.vl, s.vr);
  EXPECT_TRUE(refused(s)) << "vl and vr exchanged";
  s = good;
  s.vl = d.at('X');
  EXPECT_TRUE(refused(s)) << "a new triangle would turn over";
  s = good;
  s.w = d.at('A');
  EXPECT_TRUE(refused(s)) << "vl is not a neighbour";
  s = good;
  s.has_left = false;
  EXPECT_TRUE(refused(s)) << "no border there";
  s = good;
  s.has_left = s.has_right = false;
  EXPECT_TRUE(refused(s));
  s = good;
  s.vr = s.vl;
  EXPECT_TRUE(refused(s));
  d.tin.vertices[s.u].position = {6, 6};
  const Tin moved = d.tin;
  EXPECT_FALSE(split(d.tin, good).applied) << "u stands on w";
  EXPECT_TRUE(same(d.tin, moved));
  d.tin.vertices[s.u].position = {0, 0};
  EXPECT_FALSE(split(d.tin, good).applied) << "u stands outside of the fan";
}

/// A lattice of width x height vertices with random diagonals, some triangles void.
Tin lattice(std::mt19937_64& random, int width, int height) {
  Tin tin;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      tin.vertices.push_back({{x, y}, static_cast<HeightBits>(random() % 100), kNone});
      tin.has_height.push_back(1);
    }
  }
  for (int y = 0; y + 1 < height; ++y) {
    for (int x = 0; x + 1 < width; ++x) {
      const auto a = static_cast<VertexId>(y * width + x);
      const auto d = a + static_cast<VertexId>(width);
      const bool flip = random() % 2 == 0;
      for (const auto& [p, q, r] : {flip ? std::tuple(a, a + 1, d) : std::tuple(a, a + 1, d + 1),
                                    flip ? std::tuple(a + 1, d + 1, d) : std::tuple(a, d + 1, d)}) {
        tin.triangles.push_back({{p, q, r}, {kNone, kNone, kNone}});
        tin.classes.push_back(random() % 5 == 0 ? TriangleClass::kVoid : TriangleClass::kSurface);
      }
    }
  }
  drawn::connect(tin);
  return tin;
}

/// The triangles without numbering.
std::vector<std::tuple<VertexId, VertexId, VertexId, TriangleClass>> contents(const Tin& tin) {
  std::vector<std::tuple<VertexId, VertexId, VertexId, TriangleClass>> all;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.is_alive(t)) {
      const Triangle& triangle = tin.triangles[t];
      const int first = static_cast<int>(std::min_element(triangle.v, triangle.v + 3) - triangle.v);
      all.emplace_back(triangle.v[first], triangle.v[next_corner(first)],
                       triangle.v[previous_corner(first)], tin.classes[t]);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

RC_GTEST_PROP(CollapseThenSplit, RestoresTheMeshExactly, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const int width = 2 + static_cast<int>(random() % 7);
  const int height = 2 + static_cast<int>(random() % 7);
  Tin tin = lattice(random, width, height);
  RC_ASSERT(validate(tin).empty());
  std::vector<decltype(contents(tin))> states;
  std::vector<SplitSite> sites;
  Star star;
  for (int tries = 0; tries < 200; ++tries) {
    const auto u = static_cast<VertexId>(random() % tin.vertices.size());
    if (tin.vertices[u].triangle == kNone) {
      continue;
    }
    walk_star(tin, u, star);
    const std::size_t j = random() % star.degree();
    if (!can_collapse(tin, star, j)) {
      continue;
    }
    states.push_back(contents(tin));
    const CollapseSite s = collapse_site(star, j);
    const auto class_of = [&](TriangleId t) {
      return t == kNone ? TriangleClass::kSurface : tin.classes[t];
    };
    sites.push_back({s.u, s.w, s.vl, s.vr, s.left != kNone, s.right != kNone, class_of(s.left),
                     class_of(s.right)});
    collapse(tin, star, j);
    const std::string fault = validate(tin);
    RC_ASSERT(fault.empty());
  }
  while (!sites.empty()) {
    const SplitResult result = split(tin, sites.back());
    RC_ASSERT(result.applied);
    const std::string fault = validate(tin);
    RC_ASSERT(fault.empty());
    RC_ASSERT(contents(tin) == states.back());
    sites.pop_back();
    states.pop_back();
  }
}

/// Random sites, mostly wrong ones: a split is refused, or the mesh stays valid.
RC_GTEST_PROP(Split, NeverMakesAnInvalidMesh, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  Tin tin = lattice(random, 5, 5);
  std::fill(tin.classes.begin(), tin.classes.end(), TriangleClass::kVoid);
  for (Vertex& v : tin.vertices) {
    v.position = {v.position.x * 4, v.position.y * 4};
  }
  for (int tries = 0; tries < 300; ++tries) {
    const auto u = static_cast<VertexId>(tin.vertices.size());
    const GridPoint p{static_cast<int>(random() % 17), static_cast<int>(random() % 17)};
    if (std::any_of(tin.vertices.begin(), tin.vertices.end(),
                    [&](const Vertex& v) { return v.position == p; })) {
      continue;
    }
    tin.vertices.push_back({p, 0, kNone});
    tin.has_height.push_back(1);
    Star star;
    const auto w = static_cast<VertexId>(random() % u);
    walk_star(tin, w, star);
    SplitSite site{u, w, star.link[random() % star.degree()], star.link[random() % star.degree()]};
    if (random() % 8 == 0) {
      site.vl = static_cast<VertexId>(random() % u);
    }
    site.has_left = random() % 4 != 0;
    site.has_right = random() % 4 != 0;
    site.left_class = site.right_class = TriangleClass::kVoid;
    const Tin before = tin;
    if (!split(tin, site).applied) {
      RC_ASSERT(same(tin, before));
      tin.vertices.pop_back();
      tin.has_height.pop_back();
    }
    const std::string fault = validate(tin);
    RC_ASSERT(fault.empty());
  }
}

}  // namespace
}  // namespace ptin
