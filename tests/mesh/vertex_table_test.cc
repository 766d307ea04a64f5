// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/vertex_table.h"

#include <map>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace ptin {
namespace {

VertexId added_vertex(Tin& tin, GridPoint p) {
  tin.vertices.push_back({p, 0, kNone});
  return static_cast<VertexId>(tin.vertices.size() - 1);
}

VertexId wanted(const std::map<VertexKey, VertexId>& map, VertexKey key) {
  const auto found = map.find(key);
  return found == map.end() ? kNone : found->second;
}

RC_GTEST_PROP(VertexTable, AgreesWithAMap, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  Tin tin;
  VertexTable table;
  std::map<VertexKey, VertexId> map;
  const std::uint64_t side = std::uint64_t{1} << (1 + random() % 10);
  const auto drawn = [&] {
    return GridPoint{static_cast<int>(random() % side), static_cast<int>(random() % side)};
  };
  for (int step = 0; step < 500; ++step) {
    const GridPoint p = drawn();
    const VertexId v = added_vertex(tin, p);
    table.reserve(tin, map.size() + 1);
    RC_ASSERT(table.insert(tin, v) == map.emplace(key_of(p), v).second);
    const VertexKey asked = key_of(drawn());
    RC_ASSERT(table.find(tin, asked) == wanted(map, asked));
    const VertexKey gone = key_of(drawn());
    table.erase(tin, gone);
    map.erase(gone);
    RC_ASSERT(table.find(tin, gone) == kNone);
  }
}

// Vertices of which all have the same half of a hash, the half that a slot keeps.
GridPoint drawn_alike(std::mt19937_64& random) {
  const auto y = static_cast<std::int32_t>(random() % (1 << 24));
  return {32 * y, y};
}

// In a table that stays full, runs are long, wrap around and are closed up wherever a vertex goes;
// and the mesh has to tell the vertices of a run apart.
TEST(VertexTable, KeepsEveryOtherVertexWhenOneGoes) {
  std::mt19937_64 random(4);
  constexpr std::uint32_t kVertices = 700;
  Tin tin;
  VertexTable table;
  table.reset(kVertices / 3);  // 701 slots
  std::map<VertexKey, VertexId> map;
  for (std::uint32_t step = 0; step < 20000; ++step) {
    while (map.size() < kVertices - 1) {
      const VertexId v = added_vertex(tin, drawn_alike(random));
      ASSERT_EQ(table.insert(tin, v), map.emplace(key_of(tin.position(v)), v).second);
    }
    const auto after = map.lower_bound(key_of(drawn_alike(random)));
    const auto gone = after == map.end() ? map.begin() : after;
    table.erase(tin, gone->first);
    ASSERT_EQ(table.find(tin, gone->first), kNone);
    map.erase(gone);
    if (step % 500 == 0) {
      for (const auto& [key, vertex] : map) {
        ASSERT_EQ(table.find(tin, key), vertex);
      }
    }
  }
}

TEST(VertexTable, FindsEveryVertexOfFullLatticesOfAnySpacing) {
  for (const int spacing : {1, 2, 3, 64, 1024, 4096}) {
    Tin tin;
    VertexTable table;
    table.reset(250 * 250);
    for (int y = 0; y < 250; ++y) {
      for (int x = 0; x < 250; ++x) {
        ASSERT_TRUE(table.insert(tin, added_vertex(tin, {x * spacing, y * spacing})));
      }
    }
    for (VertexId v = 0; v < tin.vertices.size(); ++v) {
      ASSERT_EQ(table.find(tin, key_of(tin.position(v))), v);
    }
    EXPECT_EQ(table.find(tin, key_of({1 + 250 * spacing, 0})), kNone);
  }
}

}  // namespace
}  // namespace ptin
