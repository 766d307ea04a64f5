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

/// The geometry that a text of WKT describes; null when the text is no WKT.
[[nodiscard]] std::unique_ptr<OGRGeometry> geometry_of_wkt(const std::string& text);

/// True when the text begins as WKT of one of `words` does: with the word, then Z, M, ZM or
/// nothing, then `(` or EMPTY. Blanks and case do not matter.
[[nodiscard]] bool begins_as_wkt(const std::string& text, std::initializer_list<const char*> words);

/// Hands every geometry of the first layer of a vector file to `visit`, in the terrain's CRS. It is
/// transformed when the layer and the terrain both have a CRS and these differ, else it is left as
/// it is.
/// @param crs_wkt  The CRS of the terrain; empty: unknown.
/// @param visit    Takes the feature's id and its geometry, which is null where a feature has none.
/// @throws Error not_found, io_error
/// @throws Error invalid_argument  a folder; no vector file that GDAL reads; the CRS, or a
///                                 geometry, cannot be transformed
/// @throws what `visit` throws
void for_each_geometry(const std::string& path, const std::string& crs_wkt,
                       const std::function<void(long long, const OGRGeometry*)>& visit);

/// Hands the geometry, or the geometries, of `text` to `visit`. `text` is WKT where it begins as
/// WKT of one of `words` and names no file. Else it names a file with such WKT (of any length) or a
/// vector file. WKT is in the terrain's CRS.
/// @param example  WKT that would do, for errors.
/// @throws Error as for_each_geometry; not_found names both ways of giving a geometry
void read_geometries(const std::string& text, std::initializer_list<const char*> words,
                     const std::string& example, const std::string& crs_wkt,
                     const std::function<void(const OGRGeometry&)>& visit);

}  // namespace ptin::tools
