// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh on its way out: plain triangles over indexed vertices in map coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace ptin::tools {

/// What a format writer writes. Surface triangles only: void ones are left out before.
struct Mesh {
  /// x, y in the CRS's units, z in the height's unit.
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Counter-clockwise seen from above.
  /// "EPSG:32611" where the CRS has a code, else WKT2 on one line; empty when unknown.
  std::string crs;
  std::string vertical_crs;  ///< Likewise; empty when unknown.
  /// Metres in a unit of x and of y, at the middle of the mesh, and of heights; 1 where that is
  /// unknown.
  std::array<double, 3> metres_per_unit{1.0, 1.0, 1.0};
};

/// The middle of the box around all vertices; there is at least one.
[[nodiscard]] std::array<double, 3> middle_of(const Mesh& mesh);

}  // namespace ptin::tools
