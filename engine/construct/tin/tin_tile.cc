// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_tile.h"

#include <cmath>
#include <memory>

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

TileTree tin_tree(const TinTriangles& triangles, std::optional<std::int64_t> side) {
  const std::uint64_t vertices = triangles.counts().vertices;
  const auto across =
      static_cast<std::int64_t>(std::ceil(std::sqrt(static_cast<double>(vertices))));
  return TileTree::over_points(vertices, side.value_or(TileTree::default_side(across, across)),
                               std::make_shared<const ConvexHull>(triangles.hull()));
}

}  // namespace ptin
