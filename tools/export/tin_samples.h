// SPDX-License-Identifier: GPL-3.0-or-later
//
// A TIN sampled at the centres of pixels, exactly: its heights, and the normals of its triangles.
#pragma once

#include <array>
#include <vector>

#include "engine/query/terrain.h"
#include "storage/store_file.h"
#include "tools/export/pixel_grid.h"
#include "tools/slope.h"

namespace ptin::tools {

/// Samples `refined` at the pixels of `part`. The height of each centre that lies in a closed
/// surface triangle is written to its place in `heights`, which holds the pixels of `rect` row by
/// row from the north; other places are left alone. A centre on a vertex gets the vertex's height,
/// one on an edge is interpolated along the edge alone: so a height depends neither on the triangle
/// that gives it nor on the part. Weights are exact; the height is rounded where it is formed.
/// @param part  Inside of `rect`.
/// Cost: the triangles, and the pixels under them.
void sample_heights(const RefinedTin& refined, const StoreFacts& facts, const PixelGrid& grid,
                    const PixelRect& part, const PixelRect& rect, std::vector<double>& heights);

/// A normal that points up, as long as twice the area of its triangle on the grid: x and y in grid
/// units times stored height numbers, z in square grid units. 0 in z: there is none.
struct GridNormal {
  double x = 0.0, y = 0.0, z = 0.0;
};

/// The same for normals. Each place gets the sum of the normals of the closed surface triangles
/// that hold its centre, added to what is there: inside of a triangle its own, on an edge or a
/// vertex the mean of those around it, weighted by their areas. A raster of its source's own pixels
/// has all centres on vertices, where no triangle is better than the others; the mean is what
/// gdaldem's differences are there. They are added in an order of their corners' keys, so a sum
/// does not depend on the part.
/// Cost: as sample_heights(), and the triangles are sorted; 24 bytes a triangle.
void sample_normals(const RefinedTin& refined, const StoreFacts& facts, const PixelGrid& grid,
                    const PixelRect& part, const PixelRect& rect, std::vector<GridNormal>& normals);

/// The normal of a triangle; its corners counter-clockwise, from any of them on.
[[nodiscard]] GridNormal normal_of(const Tin& tin, const std::array<VertexId, 3>& corners,
                                   const HeightEncoding& heights);

/// The slope of a surface with this normal.
/// @param per_map_unit  Ground::per_map_unit at the place. At a pole, where east is no direction,
///                      nothing rises to the east.
/// REQUIRES: normal.z > 0.
[[nodiscard]] Slope slope_of(const GridNormal& normal, const StoreFacts& facts,
                             MapPoint per_map_unit);

}  // namespace ptin::tools
