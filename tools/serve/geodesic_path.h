// SPDX-License-Identifier: GPL-3.0-or-later
//
// Positions along the shortest path over ground.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/affine.h"

namespace ptin::serve {

/// Positions at equal distances over ground along a path, its two ends included, whose
/// vertices are joined by geodesics of WGS 84: across the antimeridian where that is shorter.
/// @param path     Longitude and latitude in degrees, at least two.
/// @param samples  The number of positions, at least two.
/// @return Longitudes from -180 to 180. Vertices where a sample falls on one, to the bit.
/// Cost: a few microseconds a vertex and a sample.
[[nodiscard]] std::vector<MapPoint> along_geodesics(std::span<const MapPoint> path,
                                                    std::uint64_t samples);

}  // namespace ptin::serve
