// SPDX-License-Identifier: GPL-3.0-or-later
//
// What each level of a pyramid of tiles is built to: the error of the whole, and its shares.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/query/questions.h"
#include "tools/tiles/globe.h"

namespace ptin::tools {

/// One level. A tile of it lies within `error` of every sample of the terrain: the TIN of the tile may be off by
/// 13/16 of it less half a step, heights are rounded by half a step, edges are cut in two until they
/// leave the terrain by at most 1/8, and 1/16 is left for positions, which are rounded to the
/// lattice of the level. For Cesium's tiles that is enough for slopes of 1000 % (of 70 % on the
/// finest level); where it is steeper, the slope times half a diagonal of the lattice may be added.
struct TileLevel {
  double error = 0.0;        ///< Metres.
  double tolerance = 0.0;    ///< Certified error of the TIN, height's unit.
  double height_step = 1.0;  ///< A power of two, metres: heights of all tiles are multiples of it.
  double chord = 0.0;        ///< How far edges may leave the TIN of the CRS and the curved Earth.
};

/// What the levels are chosen from.
struct LevelsWanted {
  double first_error = 77067.0;  ///< Error of level 0, metres; each level halves it.
  double first_area = 1.0;       ///< Area of a tile of level 0, in parts of the terrain's box.
  int least_finest = 0;          ///< The finest level is this one or a further one.
  int most_levels = 24;
  std::uint64_t mean_vertices = 1000;  ///< Mean of the finest level's tiles, at most.
};

/// The levels from 0 to the finest. That is the first one whose tiles would hold at most
/// `mean_vertices` of the full TIN, on the average, and no finer than the file has detail: it
/// is built to the file's finest error, or to a 16th of its share of the first one's, whichever is
/// more. (It is more than its share only where the first level is finer than the file already: then
/// that is the only level.)
[[nodiscard]] std::vector<TileLevel> tile_levels(const StoreFile& store, const Globe& globe,
                                                 const LevelsWanted& wanted);

/// The certified error of T0, metres: an upper bound of what a first level may be built to.
[[nodiscard]] double coarsest_error(const StoreFile& store, const Globe& globe);

}  // namespace ptin::tools
