// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors where surface and void meet: samples of the wrong class, and edges that move the border.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"

namespace ptin {

/// What a fan would cost in a star that holds voids.
struct VoidMeasure {
  bool allowed = false;    ///< False: a surface triangle would get a corner without a height.
  double error = 0.0;      ///< Largest residual or charge, height codes; not rounded up yet.
  double charge = 0.0;     ///< Largest charge.
  double deviation = 0.0;  ///< Largest residual in a surface triangle.
};

/// Measures every sample of the star, and the link vertices that would lose their last surface
/// triangle of this star (engine/DESIGN.md, section 3.4).
///
/// - A sample with a height is right in a closed surface triangle; a sample without a height is
///   right in a closed void triangle. A sample in the wrong class is charged its reach times the
///   slope (tile/border_witnesses.h), and so is an element with a direction.
/// - An edge that comes to be on the border is charged how far it moves the border.
/// - A sample on a spoke goes to the side of its own class.
/// - A sample on the link stays with the fan, even where the triangle beyond is of its class. So a
///   sample is always in a triangle that replaced its former one, and in any refinement the record
///   whose fan holds that triangle has charged it (engine/DESIGN.md, section 2.5). Handing samples
///   over the link loses this: the triangle beyond may be finer in another refinement, and void
///   there.
/// - For the same reason a link vertex is charged when it loses all its surface triangles of this
///   star, whatever is beyond.
/// - A sample with a height on an edge of a void fan triangle whose ends have heights is measured
///   against that edge besides: surface may lie beyond, at once or in another refinement, and hold
///   the sample too.
/// - A block is measured at its corners. A block across a spoke may lie in every fan triangle
///   between those of its corners: it is charged where one of them is of the wrong class, and its
///   residuals are bounded along the spokes.
///
/// @param fan         Its buffer `is_surface` is overwritten.
/// @param full        The full surface under the tile: how far new edges of the border move it. Null
///     in a tile of carried samples, where they are not charged.
/// @param stop_above  Returns early, with the largest so far, once the error exceeds this.
/// Cost: samples times degree, in lanes; samples that lose their surface one by one.
[[nodiscard]] VoidMeasure measure_with_voids(
    const Tile& tile, const StarSamples& s, FanFrame& fan, const FullSurface* full,
    double stop_above = std::numeric_limits<double>::infinity());

/// The fan triangle that gets a sample at (x, y), relative to u: one of its own class where it lies
/// on a spoke. Cost: the degree.
[[nodiscard]] std::size_t triangle_of_sample(const Tile& tile, const StarSamples& s,
                                             const FanFrame& fan, double x, double y,
                                             bool has_height);

/// The fan triangle that gets an element with a direction: one of its own class where it lies on a
/// spoke. Cost: the degree.
[[nodiscard]] std::size_t triangle_of_directed(const Tile& tile, const StarSamples& s,
                                               const FanFrame& fan, const DirectedElement& d);

}  // namespace ptin
