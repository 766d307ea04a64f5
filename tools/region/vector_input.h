// SPDX-License-Identifier: GPL-3.0-or-later
//
// Geometries as callers give them: WKT, a file with WKT, or a layer of a vector file.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <ogr_feature.h>
#include <ogr_geometry.h>

#include "engine/construct/read/layer_choice.h"
#include "engine/crs/crs_facts.h"
#include "tools/region/straight_sides.h"

namespace ptin::tools {

/// The geometry that a text of WKT describes; null when the text is no WKT.
[[nodiscard]] std::unique_ptr<OGRGeometry> geometry_of_wkt(const std::string& text);

/// True when the text begins as WKT of one of `words` does: with the word, then Z, M, ZM or
/// nothing, then `(` or EMPTY. Blanks and case do not matter.
[[nodiscard]] bool begins_as_wkt(const std::string& text, const std::vector<std::string>& words);

/// The plane of a terrain, into which geometries are brought.
struct TerrainPlane {
  std::string crs_wkt;  ///< Empty: unknown.
  SideTarget sides;     ///< How near a transformed side keeps to what it was.

  /// This plane for callers who ask for corners alone.
  [[nodiscard]] TerrainPlane with_corners_alone() const;
};
[[nodiscard]] TerrainPlane plane_of(const StoreFacts& facts, const CrsFacts& crs);

/// Hands every feature of a layer to `visit`, its geometry in the terrain's CRS. It is transformed
/// when the layer and the terrain both have a CRS and these differ, else it is left as it is. Sides
/// of lines and rings are straight in the CRS of the layer, arcs become chords there; what is
/// transformed has as many corners as transformed_sides() needs.
/// @param wish   Which layer of the file (engine/construct/read/layer_choice.h).
/// @param visit  Takes the feature; it may have no geometry.
/// @return What was transformed; none where nothing had to be.
/// @throws Error not_found, io_error
/// @throws Error invalid_argument  a folder; no vector file that GDAL reads; as choose_layer(); the
///                                 CRS, or a geometry, cannot be transformed
/// @throws Error as transformed_sides(), and names the feature; what `visit` throws
std::optional<Transformed> for_each_feature(const std::string& path, const LayerWish& wish,
                                            const TerrainPlane& plane,
                                            const std::function<void(const OGRFeature&)>& visit);

/// Geometries as a caller gives them: `text` is WKT where it begins as WKT of one of `words` does
/// and names no file. Else it names a file with such WKT (of any length) or a vector file. WKT is
/// in the terrain's CRS.
struct GeometrySource {
  std::string text;
  std::vector<std::string> words;
  std::string example;  ///< WKT that would do, for errors.
  LayerWish layer;      ///< Which layer of a vector file.
};

/// Hands each geometry to `visit`, with its feature, or with null where it is WKT.
/// @return As for_each_feature().
/// @throws Error as for_each_feature(); not_found names both ways of giving a geometry
std::optional<Transformed> read_geometries(
    const GeometrySource& source, const TerrainPlane& plane,
    const std::function<void(const OGRGeometry&, const OGRFeature*)>& visit);

}  // namespace ptin::tools
