// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors where surface and void meet: samples of the wrong class, charged by their depth.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/tile.h"

namespace ptin {

/// What a fan would cost in a star that holds voids.
struct VoidMeasure {
  bool allowed = false;    ///< False when a surface triangle would get a corner without height.
  double error = 0.0;      ///< Height codes; residuals and charges; not rounded up yet.
  double charge = 0.0;     ///< Largest charge alone.
  double deviation = 0.0;  ///< Largest residual in a surface triangle alone.
};

/// Measures every sample of the star, and the link vertices that would lose their last surface
/// triangle of this star.
///
/// A sample with a height is right in a closed surface triangle, one without is right outside of
/// every open one; a wrong one is charged depth * slope (engine/DESIGN.md, section 3.3). A sample on a spoke
/// goes to the side of its own class. One on the link stays with the fan, even when the triangle
/// beyond is of its class: so a sample is always in a triangle that replaced its former one, and
/// whichever records a refinement applies, the charge is in a record that it can see. (Handing
/// samples over the link loses this: the triangle beyond may be finer in another refinement, and
/// void there.) For the same reason a link vertex is charged when it loses all its surface
/// triangles of this star, whatever is beyond.
/// A data sample on an edge of a void fan triangle whose ends have heights may have surface beyond,
/// at once or in another refinement, which holds it too: it is measured against that edge besides.
///
/// A block is measured at its corners; one that lies across a spoke may be in every fan triangle
/// between those of its corners: it is charged where any of them is of the wrong class, and its
/// residuals are bounded along the spokes.
/// @param fan         Its buffer `is_surface` is overwritten.
/// @param stop_above  Returns early, with what it has, once the error exceeds this.
/// Cost: samples times degree, in lanes; those that lose their surface one by one.
[[nodiscard]] VoidMeasure measure_with_voids(
    const Tile& tile, const StarSamples& s, FanFrame& fan,
    double stop_above = std::numeric_limits<double>::infinity());

/// The fan triangle that a sample at (x, y), relative to u, goes to: one of its own class where it
/// lies on a spoke. Cost: the degree.
[[nodiscard]] std::size_t triangle_of_sample(const Tile& tile, const StarSamples& s,
                                             const FanFrame& fan, double x, double y,
                                             bool has_height);

}  // namespace ptin
