// SPDX-License-Identifier: GPL-3.0-or-later
//
// Takes the vertices of a tile off by one half-edge collapse after the other, and makes a record of
// each.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>

#include "engine/construct/collapse/cost.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"

namespace ptin {

struct SimplifyOptions {
  CostModel cost = CostModel::kError;
  /// Stop when this many vertices that are not locked are left. 0: go on while a collapse is
  /// allowed.
  std::uint64_t keep = 0;
  /// Arrays are compacted when half of the vertices are gone and there were more than this, and
  /// when lists of samples are sparse (construct/collapse/tile_compact.h). Vertices keep their
  /// order, so records do not depend on it. The largest value: nothing is compacted.
  std::size_t compact_above = 4096;
  /// Where the tile is the full TIN of a raster, and nothing was collapsed: the box whose samples
  /// fill tile.tin.vertices row by row. Its first stars are measured by a table (GridStars).
  std::optional<GridBox> full_raster;
  std::stop_token stop;
  /// Called every few thousand steps. May be empty.
  std::function<void(std::uint64_t collapsed)> progress;
};

/// Collapses vertices in the order of the cost until options.keep is reached or no collapse is
/// allowed. For each collapse a saturated record is appended to tile.records, its star to
/// tile.stars, and the samples of the star move to the fan. Locked vertices stay. Ids of vertices and triangles change when arrays
/// are compacted.
///
/// An entry of the queue may be older than its star: it is measured again when it reaches the top
/// (lazy evaluation), since errors and boxes mostly grow.
/// @param full  The full surface under the tile, for deviations.
/// @throws Error cancelled, resource_exhausted (rank above 65 535, or as SampleLists::take)
/// Deterministic. Cost: about n log n residuals for n samples. One thread.
void simplify(Tile& tile, const FullSurface& full, const SimplifyOptions& options);

/// The same for a tile that holds carried samples instead of all. The `error` of a record is its
/// own part alone, measured over these, and its `deviation` is 0. Tightening does the rest
/// (construct/hierarchy/tighten.h).
void simplify_carried_samples(Tile& tile, const SimplifyOptions& options);

}  // namespace ptin
