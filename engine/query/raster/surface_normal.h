// SPDX-License-Identifier: GPL-3.0-or-later
//
// Normals of surface triangles, from which slopes are told.
#pragma once

#include <array>

#include "engine/geometry/point.h"

namespace ptin {

/// A normal that points up, as long as twice the area of its triangle on the grid: x and y in grid
/// units times stored height numbers, z in square grid units. 0 in z: there is none.
struct GridNormal {
  double x = 0.0, y = 0.0, z = 0.0;
};

/// A corner of a triangle: its position and its height code.
struct CodedPoint {
  GridPoint position;
  double code = 0.0;
};

/// The corners from the one with the least key on: the same for a triangle however it came about.
[[nodiscard]] std::array<CodedPoint, 3> from_least(const std::array<CodedPoint, 3>& corners);

/// The normal of a triangle; its corners counter-clockwise, from any of them on.
[[nodiscard]] GridNormal normal_of(const std::array<CodedPoint, 3>& corners);

}  // namespace ptin
