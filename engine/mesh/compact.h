// SPDX-License-Identifier: GPL-3.0-or-later
//
// Drops what is removed from a mesh's arrays, so that what is left lies together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "engine/mesh/tin.h"

namespace ptin {

/// Old index to new one, for those kept, which stay in their order; kNone for the others.
using Renumbering = std::vector<std::uint32_t>;

/// Keeps of an array that lies beside what was renumbered what was kept. Cost: linear.
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

/// Drops the removed triangles. Neighbours and triangles of vertices that were removed are kNone
/// afterwards. Cost: linear.
Renumbering compact_triangles(Tin& tin);

/// Drops the vertices of no triangle. REQUIRES: no removed triangle. Cost: linear.
Renumbering compact_vertices(Tin& tin);

}  // namespace ptin
