// SPDX-License-Identifier: GPL-3.0-or-later
//
// A vertex before its height is encoded.
#pragma once

#include "engine/geometry/point.h"

namespace ptin {

/// A point, a vertex of a line or of a TIN on the grid. Its height is as PointGrid::height() has it.
struct GridVertex {
  GridPoint position;
  double height = 0.0;
  friend bool operator==(const GridVertex&, const GridVertex&) = default;
};

}  // namespace ptin
