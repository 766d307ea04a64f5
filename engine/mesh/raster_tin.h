// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full TIN of a window of a raster: every cell cut along one diagonal.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "engine/geometry/sample_range.h"
#include "engine/mesh/raster_cell.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// The full TIN of a window. A triangle is void when one of its corners has no height.
/// @param heights   Row-major, row 0 in the south. Where `valid` is 0 the height is not looked at,
///                  and the vertex gets height 0.
/// @param valid     1 for each of `heights`, 0 for a sample without one.
/// @return  Vertices are numbered row by row from the south, so that their ids are in the order of
///          their keys. Cell (i, j) has the triangles 2 * c and 2 * c + 1 with
///          c = j * (window.width - 1) + i, the triangle at its lower edge first.
/// @throws Error  invalid_argument    a width or height below 2, spans of another size, or a corner
///                                    off the grid
///                resource_exhausted  more triangles than a TriangleId counts
/// Cost: linear; 67 bytes a sample. Threads: any number of calls at once.
[[nodiscard]] Tin make_raster_tin(std::span<const HeightBits> heights,
                                  std::span<const std::uint8_t> valid, const SampleRange& window,
                                  const HeightEncoding& encoding);

/// The lone samples of a window: those with a height that touch no surface triangle, because none
/// of their cells has three corners with heights. Callers treat them as void; that changes the
/// class of no triangle and makes no other sample lone.
/// @return  Indices into `valid`, ascending. A sample on the window's border is judged by the cells
///          inside the window alone, so tiles pass a window with a margin of at least one sample.
/// Cost: linear, one byte a sample read three times; nothing else where all is valid.
[[nodiscard]] std::vector<std::uint64_t> find_lone_samples(std::span<const std::uint8_t> valid,
                                                           const SampleRange& window);

}  // namespace ptin
