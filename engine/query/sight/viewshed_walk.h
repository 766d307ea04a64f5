// SPDX-License-Identifier: GPL-3.0-or-later
//
// One target of a viewshed by itself: the line to it, walked over the mesh. For what has no order
// from front to back.
#pragma once

#include <vector>

#include "engine/query/sight/horizon.h"
#include "engine/query/walk/walk.h"

namespace ptin {

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
