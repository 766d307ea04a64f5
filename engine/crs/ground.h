// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Earth below a CRS: distances over ground, and its size, in the unit of the heights.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground_facts.h"
#include "engine/geometry/affine.h"

namespace ptin {

/// The name of the unit of lengths over ground. It is the unit of the heights. Where nothing states
/// that unit, it is the unit of the plane, or "metre" where the plane is in degrees.
[[nodiscard]] std::string unit_of_ground(const CrsFacts& crs);

/// Metres over ground of one map unit along x and of one along y, at a position: in a geographic CRS
/// on the ellipsoid. None where nobody knows the map unit; an unknown one is never taken for a
/// metre here.
[[nodiscard]] std::optional<MapPoint> metres_per_map_unit(const CrsFacts& crs, MapPoint at);

/// @param crs  Without WKT, or with one that GDAL does not understand: a plane in the unit that `crs`
///             names, or in metres with heights in metres where it names none. Heights of no known
///             unit are taken to be in the unit of the plane, or in metres where the plane is in
///             degrees.
[[nodiscard]] Ground ground_of(const CrsFacts& crs);

/// The numbers of ground_of().
[[nodiscard]] GroundFacts ground_facts_of(const CrsFacts& crs);

/// The same as JSON, by the names of GroundFacts: what the metadata of files and streams hold.
[[nodiscard]] nlohmann::json json_of(const GroundFacts& ground);

}  // namespace ptin
