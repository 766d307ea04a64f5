// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points, pairs and lines as callers give them: rows of numbers, or a vector layer.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/geometry/affine.h"

namespace ptin::tools {

/// Rows of at least `columns` numbers from a text file, or from standard input when `path` is "-":
/// separated by commas, semicolons, tabs or spaces; a first line without anything like a number is
/// a header; further columns are left alone; a UTF-8 byte order mark is skipped. All rows one
/// behind the other, `columns` numbers each.
/// @throws Error not_found, io_error, invalid_argument (names the line; a field is empty or no
/// number; a folder)
[[nodiscard]] std::vector<double> read_rows(const std::string& path, std::size_t columns);

/// The points of a text file as read_rows(), but that a header's names choose the columns
/// (engine/construct/read/column_names.h; the first two where it names neither); or of the first layer
/// of a vector file that GDAL reads, transformed to the terrain's CRS (region/vector_input.h).
/// @throws Error as read_rows(); invalid_argument  a header names one of x and y alone
[[nodiscard]] std::vector<MapPoint> read_points(const std::string& path,
                                                const std::string& crs_wkt);

/// Lines: WKT (LINESTRING, MULTILINESTRING), a file with it, or all lines of the first layer of a
/// vector file, transformed to the terrain's CRS. Each part of a line of several is one of its own.
/// @throws Error not_found, invalid_argument
[[nodiscard]] std::vector<std::vector<MapPoint>> read_lines(const std::string& text,
                                                            const std::string& crs_wkt);

}  // namespace ptin::tools
