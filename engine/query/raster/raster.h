// SPDX-License-Identifier: GPL-3.0-or-later
//
// The terrain at the centres of pixels: heights, what the centres lie on, normals of the surface.
// Rasters larger than memory are handed over block by block.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "engine/geometry/infinity.h"
#include "engine/query/raster/pixel_lattice.h"
#include "engine/query/raster/surface_normal.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/walk/point_state.h"

namespace ptin {

class OpenedTerrain;

struct RasterRequest {
  PixelLattice lattice;  ///< Where centres stand.
  PixelRect pixels;      ///< Which pixels are wanted. Columns and rows from -2^53 to 2^53.
  DetailRequest detail;  ///< The TIN that is looked at; the same for every part of a raster.
  /// Instead of `detail`: the finest TIN that has about as many vertices in the window as there are
  /// pixels (detail_for()). Another window, or another number of pixels, may get another TIN.
  bool as_fine_as_pixels = false;
  /// The level that is as fine as the pixels has no greater error, height's unit.
  double most_error = kInfinity;

  bool heights = true;
  bool states = false;   ///< Tell void from outside.
  bool normals = false;  ///< Tell the normals of the surface.
  /// The sides of a block, in pixels, >= 1.
  std::int64_t block_width = 512;
  std::int64_t block_height = 512;
  /// Half of the memory is for pixels that are not the caller's; a single block may take more.
  QueryLimits limits;
  /// Called with the share of the pixels that is done, 0 to 1: after each block, and often in
  /// between, where it may ask for a stop. May be empty.
  std::function<void(double)> progress;
};

/// A block of a raster, whole rows or not: row by row, in the order of the request's rows.
struct RasterBlock {
  PixelRect pixels;        ///< Which pixels of the request.
  std::size_t stride = 0;  ///< From the beginning of one row to that of the next, in pixels.
  const double* heights = nullptr;      ///< Height's unit; NaN where there is no surface.
  const PointState* states = nullptr;   ///< Null unless asked for.
  const GridNormal* normals = nullptr;  ///< Null unless asked for.
};

/// Takes a block; what it borrows is valid for the call.
using RasterReceiver = std::function<void(const RasterBlock&)>;

struct RasterResult {
  DetailRequest detail;          ///< The TIN that was looked at.
  double certified_error = 0.0;  ///< As LocateResult.
  double certified_deviation = 0.0;
  bool exact = false;  ///< Nothing was left out, and the file's base error is 0.
  std::uint64_t surface_pixels = 0;
  QueryCost cost;
};

/// Hands the raster over block by block. Blocks of a raster come in an order that depends on its
/// size and that of the blocks alone; those at its ends are cut.
///
/// The height of a pixel is that which locate() gives for its centre, bit for bit, however the
/// raster is cut: a centre on a vertex has the vertex's height, one on an edge a mean of the edge's
/// ends, and one on the border of a void has a height. Full detail at the positions of a raster's
/// samples gives these samples.
/// @throws Error invalid_argument    a step of 0; numbers that are not finite; no pixel, or more than
///                                   2^31 - 1 columns or rows, or some beyond 2^53; blocks without
///                                   pixels; both `as_fine_as_pixels` and a detail; as Detail
///               resource_exhausted  a block does not fit the memory, or the normals'
///                                   triangles of a single pixel not beside it
///               corruption, io_error, cancelled; what the receiver throws
/// Cost: the pages of the window's TIN, once for as many blocks as fit the memory, and some 50 ns a
/// pixel; where there are few pixels for the TIN's vertices, that of locate().
RasterResult raster(const OpenedTerrain& terrain, const RasterRequest& request,
                    const RasterReceiver& receive);

/// The same into the caller's memory: heights of request.pixels row by row, NaN without surface,
/// and what they lie on where `states` is not empty. Blocks and normals are not asked for.
/// REQUIRES: as many places as pixels.
RasterResult raster(const OpenedTerrain& terrain, const RasterRequest& request,
                    std::span<double> heights, std::span<PointState> states = {});

}  // namespace ptin
