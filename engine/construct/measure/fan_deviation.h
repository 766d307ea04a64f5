// SPDX-License-Identifier: GPL-3.0-or-later
//
// The deviation of a fan along its edges.
#pragma once

#include <limits>

#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"

namespace ptin {

/// The largest gap to the full surface, in height codes, along the edges of a fan that are new to a
/// surface triangle:
/// - inner edges with surface on one side at least;
/// - each of the two link edges at w where the triangle that vanishes there is void and the fan
///   triangle is surface.
/// Gaps along other link edges are covered by what the star carries.
/// @param within  The window of `full`: edges that do not meet this box are left out.
/// Cost: the crossings with edges of the full TIN.
[[nodiscard]] double fan_deviation(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                                   const FullSurface& full, const GridBox& within);

/// Who is asked for the gaps to fixed edges, and how far.
struct FixedQuestion {
  const FullSurface& full;
  GridBox within = {0, 0, kGridMax, kGridMax};  ///< The parameter of fan_deviation().
  double stop_above = std::numeric_limits<double>::infinity();
};

/// The same at crossings with edges of breaklines and of the boundary alone: what these count for in
/// the error of the fan. Tiles where no leaf has such edges pay nothing.
/// Where it is more than `question.stop_above`, any number above that.
[[nodiscard]] double fan_fixed_gap(const Tile& tile, const StarSamples& s, const FanFrame& fan,
                                   const FixedQuestion& question);

/// A box that every edge meets.
inline constexpr GridBox kEverywhere{0, 0, kGridMax, kGridMax};

}  // namespace ptin
