// SPDX-License-Identifier: GPL-3.0-or-later
//
// One target of a viewshed by itself: the line to it, walked over the mesh. For what has no order
// from front to back.
#pragma once

#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/sight/horizon.h"
#include "engine/query/walk/walk.h"

namespace ptin {

/// Whether a surface triangle holds a point of the void triangle `t`: the rim of a void, seen across
/// it. The sight line comes through a void triangle, which therefore looks at the targets on its
/// sides and corners that are the surface's too.
/// @param weights  Of the corners; >= 0. Cost: a corner's degree at a corner, else O(1).
[[nodiscard]] inline bool holds_surface(const Tin& tin, TriangleId t, const double (&weights)[3]) {
  const Triangle& triangle = tin.triangles[t];
  for (int i = 0; i < 3; ++i) {
    if (weights[next_corner(i)] == 0 && weights[previous_corner(i)] == 0) {
      return touches_surface(tin, triangle.v[i]);
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (weights[i] == 0) {
      const TriangleId n = triangle.n[i];
      return n != kNone && tin.classes[n] == TriangleClass::kSurface;
    }
  }
  return false;
}

/// Borrows all for its life. Threads: several may ask.
class WalkedView {
 public:
  /// @param offsets  Of the vertices from the eye; those of no height are not read.
  WalkedView(const Tin& tin, const std::vector<Offset>& offsets, Spot eye)
      : tin_(tin), offsets_(offsets), eye_(eye) {}

  /// True when no surface rises strictly above the inner part of the line to a target at `spot`, at
  /// height `z` from the eye.  @param start  Any triangle; near the eye is fast.
  /// Cost: the triangles on the way.
  [[nodiscard]] bool sees(Spot spot, double z, TriangleId start) const;

 private:
  [[nodiscard]] bool hides(const Crossing& c, bool beside_surface, double z) const;

  const Tin& tin_;
  const std::vector<Offset>& offsets_;
  Spot eye_;
};

}  // namespace ptin
