// SPDX-License-Identifier: GPL-3.0-or-later
//
// The triangles of a TIN, in any order, made into normals at the centres of pixels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/living/living_triangle.h"
#include "engine/query/raster/pixel_centres.h"
#include "engine/query/raster/surface_normal.h"

namespace ptin {

/// Gathers the surface triangles that hold centres, and sums their normals up. Each place gets the
/// sum of the normals of the closed triangles that hold its centre: inside of a triangle its own,
/// on an edge or a vertex the mean of those around it, weighted by their areas. A raster of its
/// source's own pixels has all centres on vertices, where no triangle is better than the others;
/// the mean is what gdaldem's differences are there.
class PixelNormals {
 public:
  /// @param facts, centres  Borrowed for the life of this object.
  PixelNormals(const StoreFacts& facts, const PixelCentres& centres)
      : encoding_(facts.heights), centres_(centres) {}

  void add(const LivingTriangle& t);
  /// Bytes that are held, and that so many more triangles may take while the array grows.
  [[nodiscard]] std::uint64_t bytes_with(std::size_t triangles) const noexcept {
    return 2 * (triangles_.size() + triangles) * sizeof(triangles_[0]);
  }
  /// Adds the sums to what is there. They are formed in an order of the corners' keys, so that they
  /// do not depend on the order in which triangles came, nor on how the raster was cut. Forgets the
  /// triangles.
  /// @param normals  Begins with the first centre.
  /// @param stride   From row to row.
  void sum_up(std::span<GridNormal> normals, std::size_t stride);

 private:
  const HeightEncoding encoding_;
  const PixelCentres& centres_;
  std::vector<std::array<CodedPoint, 3>> triangles_;  ///< From the corner with the least key on.
};

}  // namespace ptin
