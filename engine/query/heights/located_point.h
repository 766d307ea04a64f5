// SPDX-License-Identifier: GPL-3.0-or-later
//
// The answer for one point of a mesh, and the interval in which its height certainly is.
#pragma once

#include <array>

#include "engine/geometry/height.h"
#include "engine/query/heights/locate.h"
#include "engine/query/refine/bounded_surface.h"
#include "engine/query/walk/walk.h"
#include "storage/store_facts.h"

namespace ptin {

/// Turns a triangle so that the corner of least key comes first, however the mesh has it.
void begin_with_least(std::array<LocatedPoint::Corner, 3>& triangle);

/// The state, height and triangle of a mesh at a spot, without an interval.
/// REQUIRES: place = find_spot(tin, spot, ...).
[[nodiscard]] LocatedPoint located_at(const Tin& tin, const HeightEncoding& heights, Spot spot,
                                      const Place& place);

/// The bounds that an answer at a level gives of a triangle: those of the triangle itself, its
/// deviation no larger than the level's. None where the full TIN was asked for, since a height is no
/// interval then.
[[nodiscard]] SurfaceBounds bounds_at(const SurfaceBounds& of_triangle, const Detail& detail);

/// Sets the interval that holds the full surface at a point: the height plus and minus the
/// triangle's deviation (at least the file's base), widened by the rounding of the height, and cut
/// to the heights of the full surface below the triangle.
/// @param is_full  The point is one of the full TIN, so that its height is the very same double.
/// REQUIRES: the state of the point is surface.
void set_interval(const SurfaceBounds& bounds, bool is_full, const StoreFacts& facts,
                  LocatedPoint& point);

}  // namespace ptin
