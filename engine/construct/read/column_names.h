// SPDX-License-Identifier: GPL-3.0-or-later
//
// The names that columns of points bear in headers of text.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace ptin {

enum class Coordinate { kX, kY, kZ };

/// Which of the fields of a header names a coordinate. These names are known, in any case, quoted
/// or not; where several fields bear one of them, the name that stands first here decides:
///   x: x, easting, east, e, longitude, lon, long, point_x
///   y: y, northing, north, n, latitude, lat, point_y
///   z: z, height, h, elevation, elev, altitude, alt, point_z
/// @return  An index into `fields`; fields.size() where no field names the coordinate.
[[nodiscard]] std::size_t find_column(std::span<const std::string_view> fields, Coordinate which);

}  // namespace ptin
