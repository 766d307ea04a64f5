// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_tile.h"

#include <optional>

namespace ptin {

StartedTile start_tin_tile(const TinTriangles& triangles, const TileTree& tree,
                           const SampleRange& window, const MeasureUnits& units) {
  std::optional<GroundMetric> ground;
  if (triangles.counts().void_triangles != 0) {
    ground.emplace(triangles.frame());
  }
  return start_part(triangles.part(tree.leaf_number(window), tree.leaves()), units, *tree.hull(),
                    ground ? &*ground : nullptr);
}

}  // namespace ptin
