// SPDX-License-Identifier: GPL-3.0-or-later
//
// Drops removed triangles and unused vertices from the arrays of a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "engine/mesh/tin.h"

namespace ptin {

/// New index by old index; kNone for what is dropped. What is kept stays in its order.
using Renumbering = std::vector<std::uint32_t>;

/// Drops, from an array that lies beside a renumbered one, the elements that the renumbering drops.
/// Cost: linear.
template <typename T>
requires std::is_trivially_copyable_v<T>
void keep_numbered(const Renumbering& number, std::vector<T>& beside) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] != kNone) {
      beside[kept++] = beside[i];
    }
  }
  beside.resize(kept);
}

/// Drops the removed triangles, and returns the new ids of triangles. A Triangle::n or
/// Vertex::triangle that named a removed triangle is kNone afterwards. Cost: linear.
Renumbering compact_triangles(Tin& tin);

/// Drops the vertices that stand in no triangle, and returns the new ids of vertices. REQUIRES: the
/// mesh has no removed triangle. Cost: linear.
Renumbering compact_vertices(Tin& tin);

}  // namespace ptin
