// SPDX-License-Identifier: GPL-3.0-or-later
//
// What kind of source an input is: a raster, points or a TIN. Whoever needs to know asks here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/construct/grid/source_options.h"

namespace ptin {

/// The kinds of sources that a terrain is built from.
enum class InputKind : std::uint8_t { kRaster, kPoints, kTin };

/// The formats that points come in. A TIN is read as points where only its vertices are wanted.
enum class PointFormat : std::uint8_t { kLas, kText, kTin, kLayer };

/// The kind that a file's name alone tells, in any case of letters: .las and .laz are points, .csv,
/// .xyz, .txt and .tsv too, also followed by .gz; .ply, .obj, .2dm and .xml are TINs. None for all
/// other names. Cost: none.
[[nodiscard]] std::optional<InputKind> kind_by_name(const std::string& path);

/// True when a name says that text is packed, to be unpacked on the way: .gz, in any case.
[[nodiscard]] bool is_packed(const std::string& path);

/// The kind of an input: by its name; where the name does not tell, points when a layer or an
/// attribute is chosen, or when OGR reads the file and GDAL finds no raster in it; else a raster.
/// Cost: opens files whose name does not tell.
[[nodiscard]] InputKind kind_of_input(const std::string& path, const PointChoice& choice);

/// The format in which the points of an input are read. With a layer or an attribute chosen, files
/// of text are layers too. REQUIRES: nothing; a raster is taken for a layer, which opening refuses.
[[nodiscard]] PointFormat point_format_of(const std::string& path, const PointChoice& choice);

}  // namespace ptin
