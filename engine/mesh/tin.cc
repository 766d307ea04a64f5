// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/tin.h"

#include <algorithm>

namespace ptin {

std::size_t Tin::alive_vertices() const noexcept {
  return static_cast<std::size_t>(std::count_if(
      vertices.begin(), vertices.end(), [](const Vertex& v) { return v.triangle != kNone; }));
}

std::size_t Tin::alive_triangles() const noexcept {
  return static_cast<std::size_t>(std::count_if(triangles.begin(), triangles.end(),
                                                [](const Triangle& t) { return t.v[0] != kNone; }));
}

}  // namespace ptin
