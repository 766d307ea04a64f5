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

/// The kind that a file's name alone shows, in any case of letters. Names of points end in .las,
/// .laz, or .csv, .xyz, .txt, .tsv, these four also followed by .gz; names of TINs end in .ply,
/// .obj, .2dm, .xml, .landxml. No other name shows a kind. No file is opened.
[[nodiscard]] std::optional<InputKind> kind_by_name(const std::string& path);

/// True when a name ends in .gz, in any case: the text in the file is unpacked while it is read.
[[nodiscard]] bool is_packed(const std::string& path);

/// The kind of an input. Its name decides where it shows a kind. Otherwise an input is points when
/// `choice` names a layer or an attribute, or when OGR finds a layer in the file and GDAL finds no
/// raster; else it is a raster. Cost: opens the file where its name does not decide.
/// @throws Error invalid_argument  a file whose name does not decide is a store (.ptin)
[[nodiscard]] InputKind kind_of_input(const std::string& path, const PointChoice& choice);

/// True when the caller wants a layer of OGR's or one of its attributes, whatever the name says.
[[nodiscard]] bool wants_layer(const PointChoice& choice) noexcept;

/// The format in which the points of an input are read, by its name. Files of text are read as
/// layers where `choice` names a layer or an attribute. A raster too counts as a layer; opening it
/// as one fails. No file is opened.
[[nodiscard]] PointFormat point_format_of(const std::string& path, const PointChoice& choice);

}  // namespace ptin
