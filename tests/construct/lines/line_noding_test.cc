// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/lines/line_noding.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/lines/fixed_edges.h"
#include "engine/error.h"
#include "engine/geometry/orient.h"

namespace ptin {
namespace {

using Line = std::vector<GridVertex>;

LineGraph graph_of(const std::vector<Line>& lines, bool boundary = false) {
  LineGraph graph;
  for (const Line& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      graph.vertices.push_back(line[i]);
      if (i > 0) {
        const auto v = static_cast<std::uint32_t>(graph.vertices.size() - 1);
        graph.edges.push_back({v - 1, v, !boundary, boundary});
      }
    }
  }
  return graph;
}

NodingRules whole_rules() {
  NodingRules rules;
  rules.height_step = 1.0;
  rules.whole_heights = true;
  return rules;
}

LineGraph noded(const std::vector<Line>& lines) {
  return node_lines(graph_of(lines), whole_rules());
}

std::string refusal_of(const std::vector<Line>& lines) {
  try {
    (void)noded(lines);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    return e.message();
  }
  return "";
}

std::string text_of(const LineGraph& g) {
  std::string text;
  for (const LineEdge& e : g.edges) {
    for (const std::uint32_t v : {e.a, e.b}) {
      const GridVertex& w = g.vertices[v];
      text += "(" + std::to_string(w.position.x) + " " + std::to_string(w.position.y) + " " +
              std::to_string(std::lround(w.height)) + ")";
    }
    text += e.boundary ? "b " : " ";
  }
  return text;
}

TEST(LineNoding, CrossingLinesOfEqualHeightsGetAVertex) {
  EXPECT_EQ(text_of(noded({{{{0, 0}, 10}, {{10, 10}, 30}}, {{{0, 10}, 20}, {{10, 0}, 20}}})),
            "(0 0 10)(5 5 20) (10 0 20)(5 5 20) (5 5 20)(0 10 20) (5 5 20)(10 10 30) ");
}

TEST(LineNoding, CrossingLinesOfTwoHeightsAreRefusedWithPlaceAndHeights) {
  const std::string message =
      refusal_of({{{{0, 0}, 100}, {{100, 100}, 100}}, {{{0, 100}, 120}, {{100, 0}, 120}}});
  EXPECT_NE(message.find("at 50 50 with two heights, 100 and 120"), std::string::npos) << message;
}

/// At (10.3, 0.1), a third of a unit from the end of the second line at (10, 0).
TEST(LineNoding, CrossingsThatRoundToAVertexOfAnotherHeightAreRefused) {
  const auto crossed_at = [](double height) {
    return refusal_of({{{{0, -3}, 5}, {{20, 3}, 5}},
                       {{{10, 0}, height}, {{13, 1}, height}, {{13, -30}, height}}});
  };
  EXPECT_EQ(crossed_at(6.0), "");
  EXPECT_NE(crossed_at(50.0).find("with two heights, 5 and 50"), std::string::npos);
}

TEST(LineNoding, TakesNoMoreVerticesThanThereIsMemoryFor) {
  std::vector<Line> comb;
  for (int i = 0; i < 30; ++i) {
    comb.push_back({{{i, -1}, 5}, {{i, 40}, 5}});
    comb.push_back({{{-1, i}, 5}, {{40, i}, 5}});
  }
  NodingRules rules = whole_rules();
  rules.most_vertices = 500;
  try {
    (void)node_lines(graph_of(comb), rules);
    FAIL() << "900 crossings fit";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource_exhausted) << e.what();
  }
}

TEST(LineNoding, HeightsMayDifferByAStepAndByTheRiseOverAGridUnit) {
  const auto crossed_at = [](double height) {
    return refusal_of({{{{0, 50}, 0}, {{100, 50}, 300}}, {{{50, 0}, height}, {{50, 100}, height}}});
  };
  EXPECT_EQ(crossed_at(154.0), "");  // 3 a grid unit, and a step of 1
  EXPECT_NE(crossed_at(155.0), "");
}

TEST(LineNoding, AVertexInsideOfAnEdgeDividesItAndKeepsItsHeight) {
  EXPECT_EQ(text_of(noded({{{{0, 0}, 0}, {{10, 0}, 0}}, {{{4, 0}, 1}, {{4, 9}, 7}}})),
            "(0 0 0)(4 0 1) (4 0 1)(10 0 0) (4 0 1)(4 9 7) ");
  EXPECT_NE(refusal_of({{{{0, 0}, 0}, {{10, 0}, 0}}, {{{4, 0}, 3}, {{4, 9}, 3}}}), "");
}

TEST(LineNoding, LinesThatLieOnOneAnotherAreJoined) {
  EXPECT_EQ(text_of(noded({{{{0, 0}, 0}, {{10, 0}, 10}}, {{{14, 0}, 14}, {{4, 0}, 4}}})),
            "(0 0 0)(4 0 4) (4 0 4)(10 0 10) (10 0 10)(14 0 14) ");
  EXPECT_NE(refusal_of({{{{0, 0}, 0}, {{10, 0}, 0}}, {{{4, 0}, 5}, {{14, 0}, 5}}}), "");
  EXPECT_EQ(text_of(noded({{{{0, 0}, 3}, {{9, 0}, 3}}, {{{9, 0}, 3}, {{0, 0}, 3}}})),
            "(0 0 3)(9 0 3) ");
}

TEST(LineNoding, ALineMayCloseAndTouchItself) {
  EXPECT_EQ(noded({{{{0, 0}, 1}, {{9, 0}, 1}, {{9, 9}, 1}, {{0, 0}, 1}}}).edges.size(), 3U);
  EXPECT_EQ(noded({{{{0, 0}, 1}, {{9, 9}, 1}, {{9, 0}, 1}, {{0, 9}, 1}}}).edges.size(), 5U);
}

TEST(LineNoding, OnePositionHasOneHeight) {
  const std::string wall = refusal_of({{{{3, 3}, 5}, {{3, 3}, 9}, {{8, 3}, 9}}});
  EXPECT_NE(wall.find("at 3 3 with two heights, 5 and 9"), std::string::npos) << wall;
  EXPECT_EQ(text_of(noded({{{{3, 3}, 6}, {{8, 3}, 9}}, {{{3, 3}, 5}, {{3, 8}, 9}}})),
            "(3 3 5)(8 3 9) (3 3 5)(3 8 9) ");
}

std::vector<Line> random_level_lines(std::mt19937_64& random, std::int32_t side, int count) {
  const auto up_to = [&](std::int32_t most) {
    return static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(most + 1));
  };
  std::vector<Line> lines;
  for (int i = 0; i < count; ++i) {
    Line line;
    for (int k = up_to(3) + 2; k > 0; --k) {
      const GridPoint p{up_to(side), up_to(side)};
      line.push_back({p, 7.0});
    }
    lines.push_back(line);
  }
  return lines;
}

RC_GTEST_PROP(LineNoding, EdgesMeetInEndsAloneWhateverTheOrder, ()) {
  std::mt19937_64 random(*rc::gen::inRange<std::uint64_t>(0, 1U << 30));
  const auto side = *rc::gen::element(5, 12, 60, 1000, 1 << 20);
  std::vector<Line> lines = random_level_lines(random, side, *rc::gen::inRange(1, 12));
  const LineGraph graph = noded(lines);
  const auto at = [&](std::uint32_t v) { return graph.vertices[v].position; };
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const LineEdge& e = graph.edges[i];
    RC_ASSERT(key_of(at(e.a)) < key_of(at(e.b)));
    for (std::size_t k = i + 1; k < graph.edges.size(); ++k) {
      const LineEdge& f = graph.edges[k];
      const std::int64_t c = orient(at(e.a), at(e.b), at(f.a)),
                         d = orient(at(e.a), at(e.b), at(f.b));
      const std::int64_t a = orient(at(f.a), at(f.b), at(e.a)),
                         b = orient(at(f.a), at(f.b), at(e.b));
      RC_ASSERT(
          !(((c > 0 && d < 0) || (c < 0 && d > 0)) && ((a > 0 && b < 0) || (a < 0 && b > 0))));
    }
    for (std::uint32_t v = 0; v < graph.vertices.size(); ++v) {
      RC_ASSERT(v == e.a || v == e.b || orient(at(e.a), at(e.b), at(v)) != 0 ||
                !contains(united(box_of(at(e.a)), at(e.b)), at(v)));
    }
  }
  // Every vertex of a line is there, and near each point of a line there is an edge.
  for (const Line& line : lines) {
    for (const GridVertex& v : line) {
      const bool alone = std::all_of(line.begin(), line.end(),
                                     [&](const GridVertex& w) { return w.position == v.position; });
      RC_ASSERT(alone ||
                std::any_of(graph.vertices.begin(), graph.vertices.end(),
                            [&](const GridVertex& w) { return w.position == v.position; }));
    }
  }
  std::shuffle(lines.begin(), lines.end(), random);
  for (Line& line : lines) {
    std::reverse(line.begin(), line.end());
  }
  RC_ASSERT(text_of(noded(lines)) == text_of(graph));
}

TEST(FixedEdges, TellWhatLiesInABoundaryWithAHole) {
  LineGraph rings =
      graph_of({{{{0, 0}, 0}, {{30, 0}, 0}, {{30, 30}, 0}, {{0, 30}, 0}, {{0, 0}, 0}},
                {{{10, 10}, 0}, {{20, 10}, 0}, {{20, 20}, 0}, {{10, 20}, 0}, {{10, 10}, 0}}},
               true);
  LineGraph line = graph_of({{{{5, 5}, 0}, {{25, 25}, 0}}, {{{40, 40}, 0}, {{50, 40}, 0}}});
  const auto shift = static_cast<std::uint32_t>(rings.vertices.size());
  rings.vertices.insert(rings.vertices.end(), line.vertices.begin(), line.vertices.end());
  for (const LineEdge& e : line.edges) {
    rings.edges.push_back({e.a + shift, e.b + shift, true, false});
  }
  const FixedEdges fixed(node_lines(std::move(rings), whole_rules()));
  EXPECT_TRUE(fixed.has_boundary());
  for (const auto& [p, inside] : std::vector<std::pair<GridPoint, bool>>{{{1, 1}, true},
                                                                         {{0, 17}, true},
                                                                         {{30, 30}, true},
                                                                         {{31, 30}, false},
                                                                         {{15, 15}, false},
                                                                         {{10, 15}, true},
                                                                         {{20, 20}, true},
                                                                         {{11, 11}, false},
                                                                         {{25, 10}, true},
                                                                         {{40, 10}, false},
                                                                         {{5, 10}, true},
                                                                         {{5, 40}, false}}) {
    EXPECT_EQ(fixed.holds(p), inside) << p.x << " " << p.y;
  }
  EXPECT_TRUE(fixed.holds({0, 0}, {10, 10}, {0, 30}));
  EXPECT_FALSE(fixed.holds({10, 10}, {20, 10}, {10, 20}));
  // 8 sides; of the line the two parts outside of the hole; nothing of what lies outside.
  EXPECT_EQ(fixed.edges().size(), 10U);
  EXPECT_EQ(fixed.vertices().size(), 10U);
}

TEST(FixedEdges, SidesThatLieOnOneAnotherCancel) {
  LineGraph rings =
      graph_of({{{{0, 0}, 0}, {{10, 0}, 0}, {{10, 10}, 0}, {{0, 10}, 0}, {{0, 0}, 0}},
                {{{10, 0}, 0}, {{20, 0}, 0}, {{20, 10}, 0}, {{10, 10}, 0}, {{10, 0}, 0}}},
               true);
  const FixedEdges fixed(node_lines(std::move(rings), whole_rules()));
  EXPECT_EQ(fixed.edges().size(), 6U);
  EXPECT_TRUE(fixed.holds({10, 5}));
  EXPECT_TRUE(fixed.holds({15, 5}));
  EXPECT_FALSE(fixed.holds({21, 5}));
}

}  // namespace
}  // namespace ptin
