// SPDX-License-Identifier: GPL-3.0-or-later
//
// Polygons and what lies in them, in rationals: slow and obviously right. Shares no code with what is
// cut at polygons.
#pragma once

#include <random>
#include <utility>
#include <vector>

#include "engine/query/select/region.h"
#include "storage/store_file.h"
#include "tests/query/line_oracle.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin::reference {

[[nodiscard]] RationalPoint rational_of(MapPoint p);
/// The sides of all rings.
[[nodiscard]] std::vector<std::pair<RationalPoint, RationalPoint>> sides_of(const Polygon& polygon);
/// Whether a place lies in the polygon by the even-odd rule, or on its border.
[[nodiscard]] bool polygon_holds(const Polygon& polygon, const RationalPoint& p);
/// The distance of a place to the nearest side.
[[nodiscard]] double distance_to_border(const Polygon& polygon, MapPoint p);
/// The stretches of the way from a to b that lie in the polygon, as shares of it.
[[nodiscard]] std::vector<Shares> stretches_in(const Polygon& polygon, MapPoint a, MapPoint b);

/// Stars with and without a hole, rectangles along grid lines, and rings that cross themselves, in map
/// units; corners often at vertices.
[[nodiscard]] Polygon any_polygon(std::mt19937_64& random, const StoreFacts& facts);
/// A small terrain: a grid with or without voids, or points.
[[nodiscard]] Hierarchy small_terrain(std::uint64_t seed);

}  // namespace ptin::reference
