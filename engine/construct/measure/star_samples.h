// SPDX-License-Identifier: GPL-3.0-or-later
//
// A star laid out for measuring: link and samples relative to the vertex that would go, coordinate
// by coordinate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/construct/tile/tile.h"
#include "engine/mesh/star.h"

namespace ptin {

/// The number of samples of a star is padded to a multiple of this with copies of u, so that the
/// measuring loops have no tail. One vector of AVX-512, two of AVX2.
inline constexpr std::size_t kSampleLanes = 8;

/// A star with a link coordinate above this, relative to u, is **wide**: products of its
/// coordinates are not exact in doubles, and go through 64-bit integers. In a narrow star
/// differences of coordinates are at most 2^26 and have products of at most 2^52, whose differences
/// are integers of at most 2^53.
inline constexpr double kExactRadius = 0x1p25;

/// A block of samples (construct/tile/sample_lists.h): its south-western and its north-eastern
/// sample, relative to u, and their common height.
struct SampleBlock {
  double x0, y0, x1, y1, z;
  float reach;
  std::uint32_t source;   ///< Index of its element, which is its south-western sample.
  std::uint32_t corners;  ///< Where its other three corners begin among the samples.
};

/// An element with a direction (tile/direction.h).
struct DirectedElement {
  std::uint32_t element;
  Direction direction;
  float reach;  ///< As Sample::reach.
};

/// The star of u, relative to u: positions as exact doubles, heights as differences of codes. A
/// sample or vertex without a height has height 0. Buffers are used again.
struct StarSamples {
  Star star;
  std::vector<double> link_x, link_y, link_z;
  /// Samples: u; then the first one of each list; then the others; then the further three corners
  /// of each block; then padding. u and the samples of the lists are the **elements**.
  std::vector<double> x, y, z;
  /// What each element is charged in the wrong class, and 1 if it has no height, else 0; only where
  /// surface_only is false. Further corners and padding count as without a height, at no charge.
  std::vector<double> charge, is_void;
  std::size_t count = 0;  ///< How many elements; 0 while samples have not been gathered.
  std::vector<SampleBlock> blocks;
  /// Which elements have a direction: witnesses of triangles, not samples. Where surface_only is
  /// false they count in the arrays as without a height, at no charge, and are measured apart.
  std::vector<DirectedElement> directed;
  /// The elements as stored in the tile; filled by gather_sources().
  std::vector<Sample> source;
  double largest_xy = 0.0;   ///< Largest |coordinate| of the link.
  double largest_z = 0.0;    ///< Largest |height difference| of link and samples that have heights.
  bool surface_only = true;  ///< No void triangle in the star and no element without a height.
  bool surface_triangles = true;  ///< No void triangle in the star.
  bool void_only = false;         ///< Void triangles only, and no element with a height.
  bool flat = false;              ///< surface_only and of one height: no residual whatever the fan.

  [[nodiscard]] bool is_wide() const noexcept { return largest_xy > kExactRadius; }
};

/// Gathers the star of `u`: link, flags, and the samples unless the star is void_only or flat. In
/// such a star every residual is 0, so lakes, seas and voids, whose triangles cover many samples,
/// cost no more than other ground. Cost: its degree and its samples.
void gather_star(const Tile& tile, VertexId u, StarSamples& out);

/// Gathers the samples of a star where gather_star() left them out.
void gather_samples(const Tile& tile, StarSamples& out);

/// Gathers the star of `u` with all samples and sources, also where it is void_only or flat.
void gather_star_and_samples(const Tile& tile, VertexId u, StarSamples& out);

/// Fills `source` of a gathered star, in the order of its samples.
void gather_sources(const Tile& tile, StarSamples& out);

}  // namespace ptin
