// SPDX-License-Identifier: GPL-3.0-or-later
//
// Geometries as callers give them: WKT, a file with WKT, or a layer of a vector file.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <ogr_feature.h>
#include <ogr_geometry.h>

#include "engine/construct/read/layer_choice.h"

namespace ptin::tools {

/// The geometry that a text of WKT describes; null when the text is no WKT.
[[nodiscard]] std::unique_ptr<OGRGeometry> geometry_of_wkt(const std::string& text);

/// True when the text begins as WKT of one of `words` does: with the word, then Z, M, ZM or
/// nothing, then `(` or EMPTY. Blanks and case do not matter.
[[nodiscard]] bool begins_as_wkt(const std::string& text, const std::vector<std::string>& words);

/// Hands every feature of a layer to `visit`, its geometry in the terrain's CRS. It is transformed
/// when the layer and the terrain both have a CRS and these differ, else it is left as it is.
/// @param wish     Which layer of the file (engine/construct/read/layer_choice.h).
/// @param crs_wkt  The CRS of the terrain; empty: unknown.
/// @param visit    Takes the feature; it may have no geometry.
/// @throws Error not_found, io_error
/// @throws Error invalid_argument  a folder; no vector file that GDAL reads; as choose_layer(); the
///                                 CRS, or a geometry, cannot be transformed
/// @throws what `visit` throws
void for_each_feature(const std::string& path, const LayerWish& wish, const std::string& crs_wkt,
                      const std::function<void(const OGRFeature&)>& visit);

/// Geometries as a caller gives them: `text` is WKT where it begins as WKT of one of `words` does
/// and names no file. Else it names a file with such WKT (of any length) or a vector file. WKT is
/// in the terrain's CRS.
struct GeometrySource {
  std::string text;
  std::vector<std::string> words;
  std::string example;  ///< WKT that would do, for errors.
  LayerWish layer;      ///< Of a vector file.
};

/// Hands each geometry to `visit`, with its feature, or with null where it is WKT.
/// @throws Error as for_each_feature(); not_found names both ways of giving a geometry
void read_geometries(const GeometrySource& source, const std::string& crs_wkt,
                     const std::function<void(const OGRGeometry&, const OGRFeature*)>& visit);

}  // namespace ptin::tools
