// SPDX-License-Identifier: GPL-3.0-or-later
//
// Takes the vertices of a tile off, one half-edge collapse after the other, and writes a record for
// each.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "engine/construct/tile/cost.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"

namespace ptin {

struct SimplifyOptions {
  CostModel cost = CostModel::kError;
  std::uint64_t keep = 0;  ///< Stop when this many vertices that are not locked are left; 0 goes on
                           ///< while a collapse is allowed.
  /// Arrays of the tile that are longer than this are made shorter when half of the vertices are
  /// gone (tile_compact.h); what is left keeps its order, and the records do not depend on it.
  /// The largest value leaves them alone.
  std::size_t compact_above = 4096;
  std::stop_token stop;
  std::function<void(std::uint64_t collapsed)>
      progress;  ///< Called every few thousand collapses; may be empty.
};

/// Collapses vertices in the order of the cost until options.keep is reached or no collapse is
/// allowed; appends a saturated record for each to tile.records and moves the samples of the star
/// to the fan. Locked vertices stay. Ids of vertices and triangles change when arrays are
/// compacted.
///
/// An entry of the queue may be older than its star: it is measured again when it reaches the top
/// (lazy evaluation), since errors and boxes mostly grow.
/// @param full  The full surface under the tile, for deviations.
/// @throws Error cancelled, resource_exhausted (rank above 65 535)
/// Deterministic. Cost: about n log n residuals for n samples. One thread.
void simplify(Tile& tile, const FullSurface& full, const SimplifyOptions& options);

/// The same for a tile that holds witnesses instead of all samples: the `error` of a record is its
/// own part alone, measured over the witnesses, `deviation` is 0, and dependencies are noted in the
/// tile. Tightening does the rest (tighten.h).
void simplify_witnesses(Tile& tile, const SimplifyOptions& options);

}  // namespace ptin
