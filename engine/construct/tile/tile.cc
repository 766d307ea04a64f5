// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/tile.h"

#include <algorithm>
#include <cfloat>
#include <limits>

#include "engine/large_array.h"

namespace ptin {

namespace {

/// A void sample is known by the sign of its reach.
float signed_reach(float reach, bool has_height) {
  return has_height ? reach : -std::max(reach, FLT_MIN);
}

void add_corner_witnesses(Tile& tile, const std::vector<CornerWitness>& witnesses) {
  for (const CornerWitness& w : witnesses) {
    const VertexId v = tile.tin.triangles[w.triangle].v[w.way.corner];
    const bool surface = tile.tin.classes[w.triangle] == TriangleClass::kSurface;
    const Sample sample{tile.tin.position(v), surface ? tile.tin.vertices[v].height : 0,
                        signed_reach(w.reach, surface), 0, w.way.direction};
    CarriedState& carried = tile.carried[w.triangle];
    carried.samples = tile.samples.take(1);
    tile.samples.samples(carried.samples).front() = sample;
    (surface ? carried.holds_heights : carried.holds_voids) = true;
  }
}

}  // namespace

void start_tile(Tile& tile, const BorderWitnesses* witnesses) {
  const Tin& tin = tile.tin;
  reserve_large(tile.carried, tin.triangles.size());
  tile.carried.assign(tin.triangles.size(), {});
  reserve_large(tile.vertex_state, tin.vertices.size());
  tile.vertex_state.assign(tin.vertices.size(), {});
  for (const Triangle& triangle : tin.triangles) {
    for (int i = 0; i < 3; ++i) {
      ++tile.vertex_state[triangle.v[i]].degree;
      if (triangle.n[i] == kNone) {  // at a border there is one neighbour more than triangles
        ++tile.vertex_state[triangle.v[previous_corner(i)]].degree;
      }
    }
  }
  tile.has_voids = std::any_of(tin.classes.begin(), tin.classes.end(),
                               [](TriangleClass c) { return c == TriangleClass::kVoid; });
  for (std::size_t v = 0; v < tin.vertices.size(); ++v) {
    const float reach =
        witnesses == nullptr ? std::numeric_limits<float>::infinity() : witnesses->reach[v];
    tile.vertex_state[v].reach = signed_reach(reach, tin.has_height[v] != 0);
  }
  // Capacities are powers of two: a third more than the samples.
  tile.samples.reserve(tin.vertices.size() + tin.vertices.size() / 3);
  reserve_large(tile.records, tin.vertices.size());
  if (witnesses != nullptr) {
    add_corner_witnesses(tile, witnesses->corners);
  }
}

std::vector<float> deaths_of(const Tile& tile) {
  std::vector<float> deaths(tile.tin.triangles.size(), kLivesOn);
  for (TriangleId t = 0; t < deaths.size(); ++t) {
    if (const std::uint32_t successor = tile.carried[t].record;
        tile.tin.is_alive(t) && successor != kNone) {
      deaths[t] = tile.records[successor].error;
    }
  }
  return deaths;
}

}  // namespace ptin
