// SPDX-License-Identifier: GPL-3.0-or-later
//
// The names that columns of points bear: in headers of text, in --columns, as attributes of layers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ptin {

enum class Coordinate : std::uint8_t { kX, kY, kZ };

/// What a column holds: a coordinate of a point, or of one of the two ends of a line.
struct ColumnRole {
  Coordinate coordinate = Coordinate::kX;
  int end = 0;  ///< 1 or 2: of the first or second end; 0: of a point.
};

/// How a role is named: "x", "y", "z", of ends "x1", "h1", "y2".
[[nodiscard]] std::string name_of(ColumnRole role);

/// Which of the names stands for a role. These are known, in any case; where several of them are
/// there, the one that stands first here decides:
///   x: x, easting, eastings, east, e, longitude, lon, long, lng, point_x, x_coord, xcoord
///   y: y, northing, northings, north, n, latitude, lat, point_y, y_coord, ycoord
///   z: z, height, h, elevation, elev, ele, altitude, alt, point_z, z_coord, zcoord
/// Those of an end have its number behind them, as x1, lat_2. A unit may follow (named_column());
/// names without one come first.
/// @return  An index into `names`; names.size() where none of them stands for the role.
[[nodiscard]] std::size_t find_column(std::span<const std::string> names, ColumnRole role);

/// A name and the unit that it gives for its column.
struct NamedColumn {
  std::string_view name;
  std::string_view unit;  ///< Empty where it gives none.
};
/// Takes the unit off a name: what stands in brackets behind it, as in "z [ft]" and "z(m)", or a
/// known unit behind a line, as in "z_ft".
[[nodiscard]] NamedColumn named_column(std::string_view name);

/// The unit as a CRS names it, as of height_unit_named(), or "degree"; "" where it is not known.
[[nodiscard]] std::string unit_of_column(std::string_view name);

/// True for the names that find_column() knows, of points and of ends.
[[nodiscard]] bool is_coordinate_name(std::string_view name);

/// The columns of the roles among `names`, which the caller gave (`build --columns`).
/// @throws Error  invalid_argument  they name a role twice, or not at all
[[nodiscard]] std::vector<std::size_t> columns_of(std::span<const std::string> names,
                                                  std::span<const ColumnRole> roles);

/// The roles of points that a terrain is built from: x, y and z.
[[nodiscard]] std::span<const ColumnRole> point_roles() noexcept;

[[nodiscard]] bool equal_in_any_case(std::string_view a, std::string_view b);

}  // namespace ptin
