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

/// Samples are padded to a multiple of this with copies of u, so that the measuring loops have no
/// tail.
inline constexpr std::size_t kSampleLanes = 4;

/// Above this, products of coordinates are not exact in doubles and go through 64-bit integers:
/// differences of coordinates below 2^26 have products below 2^52, whose difference is an integer
/// below 2^53.
inline constexpr double kExactRadius = 0x1p25;

/// A block of samples (sample_lists.h), relative to u: its outermost samples.
struct SampleBlock {
  double x0, y0, x1, y1, z;
  float depth;
  std::uint32_t source;   ///< Index of its element, and of its south-western corner as a sample.
  std::uint32_t corners;  ///< Where its other three corners begin among the samples.
};

/// The star of u, relative to u: positions as exact doubles, heights as differences of codes.
/// Buffers are used again.
struct StarSamples {
  Star star;
  std::vector<double> link_x, link_y, link_z;
  /// Samples: u first, then the first of every triangle's list, then the others, then the further
  /// corners of blocks; padded.
  std::vector<double> x, y, z;
  /// Beside x, where surface and void meet (not surface_only): what a sample is charged in the
  /// wrong class, and 1 for one without a height, else 0. Copies count as without, at no charge.
  std::vector<double> charge, is_void;
  std::size_t count = 0;  ///< Elements of the lists and u, without further corners and padding.
  std::vector<SampleBlock> blocks;
  /// The same elements as stored; filled by gather_sources().
  std::vector<Sample> source;
  double largest_xy = 0.0;   ///< Largest |coordinate| of the link.
  double largest_z = 0.0;    ///< Largest |height difference| of link and samples that have heights.
  bool surface_only = true;  ///< No void triangle in the star and no sample without height in it.
  bool surface_triangles = true;  ///< No void triangle in the star.
  bool void_only =
      false;          ///< Only void triangles, and no sample with a height in them, u included.
  bool flat = false;  ///< surface_only, and every height is the same: no residual whatever the fan.

  [[nodiscard]] bool is_wide() const noexcept { return largest_xy > kExactRadius; }
};

/// Gathers the star of `u`: link and flags, and the samples where a residual can differ from 0: not
/// where the star is void_only or flat. So lakes, seas and voids, whose triangles cover many
/// samples, cost no more than others. Cost: its degree and its samples.
void gather_star(const Tile& tile, VertexId u, StarSamples& out);

/// Gathers the samples of a star where gather_star() left them out.
void gather_samples(const Tile& tile, StarSamples& out);

/// Gathers the star of `u` with all samples and sources, whatever they are like.
void gather_star_and_samples(const Tile& tile, VertexId u, StarSamples& out);

/// Fills `source` of a gathered star, in the order of its samples.
void gather_sources(const Tile& tile, StarSamples& out);

}  // namespace ptin
