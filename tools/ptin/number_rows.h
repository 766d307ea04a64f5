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

/// The points of a text file as read_rows(), or of the first layer of a vector file that GDAL
/// reads.
[[nodiscard]] std::vector<MapPoint> read_points(const std::string& path);

/// A line: WKT (LINESTRING), a file with it, or the first line of a vector file.
/// @throws Error not_found, invalid_argument
[[nodiscard]] std::vector<MapPoint> read_line(const std::string& text);

}  // namespace ptin::tools
