// SPDX-License-Identifier: GPL-3.0-or-later
//
// The star of a vertex: the triangles around it, walked counter-clockwise.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/mesh/tin.h"

namespace ptin {

/// The star of `center`. Triangle i is (center, link[i], link[i + 1]).
/// - Closed, around an interior vertex: as many link vertices as triangles; indices are cyclic.
/// - Open, around a border vertex: one link vertex more than triangles. The first is the next
///   vertex along the border (counter-clockwise round the domain), the last is the previous one.
struct Star {
  VertexId center = kNone;
  bool closed = true;
  std::vector<TriangleId> triangles;
  std::vector<VertexId> link;

  [[nodiscard]] std::size_t degree() const noexcept { return link.size(); }
  /// Index of the triangle before triangle `i`, cyclically. REQUIRES: the star is closed, or i > 0.
  [[nodiscard]] std::size_t before(std::size_t i) const noexcept {
    return i == 0 ? triangles.size() - 1 : i - 1;
  }
  [[nodiscard]] std::size_t after(std::size_t i) const noexcept {
    return i + 1 == triangles.size() ? 0 : i + 1;
  }
};

/// Walks the star of `v` into `star`, and uses the buffers of `star` again. REQUIRES: `v` is alive
/// and the mesh valid. Cost: the degree of `v`.
void walk_star(const Tin& tin, VertexId v, Star& star);

}  // namespace ptin
