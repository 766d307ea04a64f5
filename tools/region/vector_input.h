// SPDX-License-Identifier: GPL-3.0-or-later
//
// Geometries as callers give them: WKT, a file with WKT, or the first layer of a vector file.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>

#include <ogr_geometry.h>

namespace ptin::tools {

/// The geometry that a text is as WKT; null when it is none.
[[nodiscard]] std::unique_ptr<OGRGeometry> geometry_of_wkt(const std::string& text);

/// True when the text begins, but for blanks and whatever the case, with one of these words as WKT
/// does: `(` or EMPTY follows, or before that Z, M or ZM.
[[nodiscard]] bool begins_as_wkt(const std::string& text, std::initializer_list<const char*> words);

/// Hands every geometry of the first layer to `visit`, in the terrain's CRS: transformed when the
/// layer and the terrain both have one and they differ, else as it is.
/// @param crs_wkt  Of the terrain; empty: unknown.
/// @param visit    (feature id, geometry; null where a feature has none).
/// @throws Error not_found, io_error; invalid_argument  a folder; no vector file that GDAL reads;
///               the CRS, or a geometry, cannot be transformed
///               what `visit` throws
void for_each_geometry(const std::string& path, const std::string& crs_wkt,
                       const std::function<void(long long, const OGRGeometry*)>& visit);

/// Hands the geometry, or geometries, of `text` to `visit`: WKT where it begins as WKT of
/// one of `words` and is no file, else the name of a file with such WKT (of any length) or of a
/// vector file. WKT is in the terrain's CRS.
/// @param example  WKT that would do, for errors.
/// @throws Error as for_each_geometry; not_found names the option's two ways
void read_geometries(const std::string& text, std::initializer_list<const char*> words,
                     const std::string& example, const std::string& crs_wkt,
                     const std::function<void(const OGRGeometry&)>& visit);

}  // namespace ptin::tools
