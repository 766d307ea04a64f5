// SPDX-License-Identifier: GPL-3.0-or-later
//
// One target of a viewshed at a time: the line to it, walked over the mesh. For targets in
// triangles that have no order from front to back.
#pragma once

#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/sight/horizon.h"
#include "engine/query/walk/walk.h"

namespace ptin {

/// Whether a point of the void triangle `t` is on the rim of the void: some surface triangle holds
/// it too. A sight line across the void comes to such a target through a void triangle, so the void
/// triangle looks at it.
/// @param weights  Weights of the corners of `t` at the point; >= 0.
/// Cost: a corner's degree at a corner, else O(1).
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

/// Finds what an eye sees by walking to each target. Borrows all for its life. Threads: several may
/// ask.
class WalkedView {
 public:
  /// @param offsets  Vertices from the eye; z is not read for vertices without a height.
  WalkedView(const Tin& tin, const std::vector<Offset>& offsets, Spot eye)
      : tin_(tin), offsets_(offsets), eye_(eye) {}

  /// True when no surface rises strictly above the inner part of the line to a target at `spot`,
  /// which is `z` higher than the eye.
  /// @param start  Any triangle; one near the eye is fast.
  /// Cost: the triangles on the way.
  [[nodiscard]] bool sees(Spot spot, double z, TriangleId start) const;

 private:
  [[nodiscard]] bool hides(const Crossing& c, bool beside_surface, double z) const;

  const Tin& tin_;
  const std::vector<Offset>& offsets_;
  Spot eye_;
};

}  // namespace ptin
