// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the observer of a viewshed stands.
#pragma once

#include "engine/mesh/tin.h"
#include "engine/query/shape/spot.h"
#include "engine/query/sight/viewshed.h"
#include "storage/store_file.h"

namespace ptin {

struct ViewshedEye {
  Spot spot;
  TriangleId triangle = kNone;  ///< A closed triangle that holds the spot.
  double height = 0;            ///< Absolute, height's unit.
  double above_ground = 0;      ///< Height's unit; infinite over a void.
};

/// Finds where the observer of `request` stands on `tin`.
/// @throws Error invalid_argument  outside of the terrain; on a void without an absolute height;
///                                 below the surface
[[nodiscard]] ViewshedEye find_eye(const Tin& tin, const StoreFacts& facts,
                                   const ViewshedRequest& request);

}  // namespace ptin
