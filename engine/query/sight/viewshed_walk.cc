// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/viewshed_walk.h"

namespace ptin {

/// Between crossings both the line and the surface are straight: only crossings can hide.
bool WalkedView::sees(Spot spot, double z, TriangleId start) const {
  if (spot == eye_) {
    return true;
  }
  LineWalk walk(tin_, eye_, spot, start);
  bool before = false;  // the piece before was surface
  while (walk.next()) {
    const LinePiece& piece = walk.piece();
    const bool surface = piece.is_surface(tin_);
    if (hides(piece.from, surface || before, z) || hides(piece.to, surface, z)) {
      return false;
    }
    before = surface;
  }
  return true;
}

bool WalkedView::hides(const Crossing& c, bool beside_surface, double z) const {
  if (c.numerator <= 0 || c.numerator >= c.denominator) {
    return false;  // the eye and the target do not hide
  }
  if (!beside_surface &&
      !(c.footing.lies() == Lies::kOnVertex && touches_surface(tin_, c.footing.vertex[0]))) {
    return false;
  }
  double sum = 0;
  double height = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(c.footing.count); ++i) {
    const auto weight = static_cast<double>(c.footing.weight[i]);
    height += weight * offsets_[c.footing.vertex[i]].z;
    sum += weight;
  }
  return height / sum > c.share() * z;
}

}  // namespace ptin
