// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points, pairs and lines as callers give them: rows of numbers, or a vector layer.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/geometry/affine.h"

namespace ptin::tools {

/// Reads rows of at least `columns` numbers from a text file, or from standard input when `path` is
/// "-".
/// - Fields are separated by commas, semicolons, tabs or spaces; further fields of a row are left
///   alone.
/// - A first line without anything like a number is a header, and is skipped.
/// - A UTF-8 byte order mark is skipped.
///
/// @return All rows one behind the other, `columns` numbers each.
/// @throws Error not_found, io_error, invalid_argument (names the line; a field is empty or no
/// number; a folder)
[[nodiscard]] std::vector<double> read_rows(const std::string& path, std::size_t columns);

/// Reads points from a text file or from the first layer of a vector file.
/// - Text is read as by read_rows(), but that the names of a header choose the columns
///   (engine/construct/read/column_names.h); where they name neither x nor y, the first two columns
///   are taken.
/// - Points of a layer that GDAL reads are transformed to the terrain's CRS
///   (tools/region/vector_input.h).
///
/// @throws Error as read_rows(); invalid_argument  a header names one of x and y alone
[[nodiscard]] std::vector<MapPoint> read_points(const std::string& path,
                                                const std::string& crs_wkt);

/// Reads lines from WKT (LINESTRING, MULTILINESTRING), from a file with WKT, or from the first
/// layer of a vector file, which is transformed to the terrain's CRS. Each part of a multi-line is
/// a line of its own.
/// @throws Error not_found, invalid_argument
[[nodiscard]] std::vector<std::vector<MapPoint>> read_lines(const std::string& text,
                                                            const std::string& crs_wkt);

}  // namespace ptin::tools
