// SPDX-License-Identifier: GPL-3.0-or-later
//
// The names that columns of points bear in headers of text.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace ptin {

enum class Coordinate { kX, kY, kZ };

/// Which field names a coordinate: x, easting, lon, longitude, point_x; y, northing, lat, latitude,
/// point_y; z, height, elevation, altitude, point_z and their short forms, in any case, quoted or
/// not. Where several do, the first name of that order. `fields.size()` where none does.
[[nodiscard]] std::size_t find_column(std::span<const std::string_view> fields, Coordinate which);

}  // namespace ptin
