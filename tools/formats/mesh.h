// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh on its way out: plain triangles over indexed vertices in map coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/crs/crs_facts.h"

namespace ptin::tools {

/// Where a format with float32 coordinates has its origin, and the number of its units in a unit of
/// x, y and height: local = (map - origin) * scale.
struct LocalFrame {
  std::array<double, 3> origin{};
  std::array<double, 3> scale{1.0, 1.0, 1.0};

  [[nodiscard]] std::array<double, 3> to_local(const std::array<double, 3>& p) const {
    return {(p[0] - origin[0]) * scale[0], (p[1] - origin[1]) * scale[1],
            (p[2] - origin[2]) * scale[2]};
  }
};

/// What a format writer writes. Surface triangles only: void ones are left out before.
struct Mesh {
  /// x, y in the CRS's units, z in the height's unit.
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Counter-clockwise seen from above.
  CrsFacts crs;
  /// Metres in a unit of x and of y, at the middle of the mesh, and of heights; 1 where that is
  /// unknown.
  std::array<double, 3> metres_per_unit{1.0, 1.0, 1.0};
  LocalFrame frame;  ///< For formats that keep a frame for all parts of a terrain.
};

/// The middle of the box around all vertices; there is at least one.
[[nodiscard]] std::array<double, 3> middle_of(const Mesh& mesh);

}  // namespace ptin::tools
