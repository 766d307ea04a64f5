// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/coarsest_tin.h"

#include <algorithm>
#include <cmath>

namespace ptin {

bool has_void(const CoarsestTin& t0) noexcept {
  return std::any_of(t0.triangles.begin(), t0.triangles.end(),
                     [](const CoarsestTin::T& t) { return t.is_void != 0; }) ||
         std::any_of(t0.vertices.begin(), t0.vertices.end(),
                     [](const CoarsestTin::V& v) { return v.has_height == 0; });
}

const char* fault_in(const CoarsestTin& t0, const StoreFacts& facts) noexcept {
  for (const CoarsestTin::V& v : t0.vertices) {
    if (!contains(facts.bounds, v.position)) {
      return "a vertex of T0 lies outside of the bounds";
    }
    if (v.has_height > 1 || (v.has_height == 1 && !std::isfinite(facts.heights.code(v.height)))) {
      return "a vertex of T0 has a height that is no number";
    }
  }
  for (const CoarsestTin::T& t : t0.triangles) {
    for (int i = 0; i < 3; ++i) {
      if (t.v[i] >= t0.vertices.size() || t.v[i] == t.v[i == 2 ? 0 : i + 1]) {
        return "a triangle of T0 has a corner that is no vertex, or has one twice";
      }
      if (t.is_void == 0 && t0.vertices[t.v[i]].has_height == 0) {
        return "a surface triangle of T0 has a corner without a height";
      }
    }
    if (std::isnan(t.death)) {
      return "a triangle of T0 dies at an error that is no number";
    }
    if (t.is_void > 1) {
      return "a triangle of T0 is neither surface (0) nor void (1)";
    }
  }
  return nullptr;
}

}  // namespace ptin
