// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/tile.h"

#include <algorithm>
#include <limits>

#include "engine/large_array.h"

namespace ptin {

void start_tile(Tile& tile, const std::vector<float>& depths) {
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
    const float depth = depths.empty() ? std::numeric_limits<float>::infinity() : depths[v];
    tile.vertex_state[v].depth = tin.has_height[v] != 0 ? depth : -depth;
  }
  // Capacities are powers of two: a third more than the samples.
  tile.samples.reserve(tin.vertices.size() + tin.vertices.size() / 3);
  reserve_large(tile.records, tin.vertices.size());
}

}  // namespace ptin
