// SPDX-License-Identifier: GPL-3.0-or-later
//
// A TIN sampled at the centres of pixels, exactly: its heights, and the normals of its triangles.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "engine/query/questions.h"
#include "storage/store_file.h"
#include "tools/export/pixel_grid.h"
#include "tools/slope.h"

namespace ptin::tools {

/// Heights of a TIN at the centres of a rectangle of pixels, from its triangles in any order. The
/// height of each centre that lies in a closed surface triangle is set; a centre on a vertex gets
/// the vertex's height, one on an edge is interpolated along the edge alone: so a height does not
/// depend on the triangle that gives it. Weights are exact; the height is rounded where it is
/// formed.
class HeightSamples {
 public:
  /// @param heights  Borrowed: `rect` row by row from the north. NaN where there is no height yet;
  ///                 other places are left alone.
  HeightSamples(const StoreFacts& facts, const PixelGrid& grid, const PixelRect& rect,
                std::vector<double>& heights);
  ~HeightSamples();
  HeightSamples(const HeightSamples&) = delete;
  HeightSamples& operator=(const HeightSamples&) = delete;
  /// Cost: the pixels under the triangle.
  void add(const LivingTriangle& t);

 private:
  bool add_corners(const LivingTriangle& t);

  struct Impl;
  std::unique_ptr<const Impl> impl_;
  std::vector<double>& heights_;
};

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
void sample_normals(const Tin& tin, const StoreFacts& facts, const PixelGrid& grid,
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
