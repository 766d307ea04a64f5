// SPDX-License-Identifier: GPL-3.0-or-later
//
// A star laid out for measuring: link and samples relative to the vertex that would go, coordinate by coordinate.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/construct/tile.h"
#include "engine/mesh/star.h"

namespace ptin {

/// Samples are padded to a multiple of this with copies of u, so that the measuring loops have no tail.
inline constexpr std::size_t kSampleLanes = 8;

/// The star of u, relative to u: positions as exact doubles, heights as differences of codes. Buffers are used again.
struct StarSamples {
  Star star;
  std::vector<double> link_x, link_y, link_z;
  std::vector<double> x, y, z;  ///< Samples: u first, then the first of every triangle's list, then the others; padded.
  std::vector<Sample> source;   ///< The same samples, not padded.
  double largest_xy = 0.0;      ///< Largest |coordinate| of the link.
  double largest_z = 0.0;       ///< Largest |height difference| of link and samples that have heights.
  bool surface_only = true;     ///< No void triangle in the star and no sample without height in it.
  bool void_only = false;       ///< Only void triangles, and no sample with a height in them, u included.
};

/// Gathers the star of `u`. Cost: its degree and its samples.
void gather_star(const Tile& tile, VertexId u, StarSamples& out);

}  // namespace ptin
