// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/geotiff_crs.h"

#include <memory>

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "tools/output/gdal_output.h"

namespace ptin::tools {

namespace {

/// The code of EPSG for the geographic CRS below a projected one with heights above its ellipsoid; ""
/// where there is none. GeoTIFF 1.1 names such heights by it.
std::string code_of_solid(const OGRSpatialReference& srs) {
  const std::unique_ptr<OGRSpatialReference> below(srs.CloneGeogCS());
  if (below == nullptr) return {};
  if (below->GetAxesCount() == 2 && below->PromoteTo3D(nullptr) != OGRERR_NONE) return {};
  const char* const authority = below->GetAuthorityName(nullptr);
  const char* const code = below->GetAuthorityCode(nullptr);
  const bool is_solid = below->GetAxesCount() == 3 && authority != nullptr && code != nullptr;
  return is_solid && EQUAL(authority, "EPSG") ? code : "";
}

bool is_in_metres(const OGRSpatialReference& srs) {
  double metres = 0.0;
  return srs.GetAxis(nullptr, 2, nullptr, &metres) != nullptr && metres == 1.0;
}

/// A projected CRS of three axes as GDAL writes it.
OGRSpatialReference writable(const OGRSpatialReference& solid, bool has_heights) {
  OGRSpatialReference plane(solid);
  plane.DemoteTo2D(nullptr);
  // A plane with its code is read again by more programs than one that is spelled out.
  if (const std::unique_ptr<OGRSpatialReference> known(plane.FindBestMatch()); known != nullptr) {
    plane = *known;
  }
  const std::string code = has_heights && is_in_metres(solid) ? code_of_solid(solid) : "";
  OGRSpatialReference heights, both;
  const std::string text =
      R"(VERT_CS["ellipsoid",VERT_DATUM["ellipsoid",2002],UNIT["metre",1],AXIS["Up",UP],)"
      R"(AUTHORITY["EPSG",")" +
      code + R"("]])";
  const bool is_made = !code.empty() && heights.importFromWkt(text.c_str()) == OGRERR_NONE &&
                       both.SetCompoundCS(plane.GetName(), &plane, &heights) == OGRERR_NONE;
  return is_made ? both : plane;
}

}  // namespace

void set_geotiff_crs(GDALDataset& dataset, const std::string& wkt, bool has_heights,
                     const std::string& path) {
  OGRSpatialReference srs;
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (wkt.empty() || srs.importFromWkt(wkt.c_str()) != OGRERR_NONE) return;
  const bool is_solid = srs.IsProjected() != 0 && srs.IsCompound() == 0 && srs.GetAxesCount() == 3;
  if (is_solid) srs = writable(srs, has_heights);
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  require_done(dataset.SetSpatialRef(&srs), "cannot give the raster its CRS", path);
}

}  // namespace ptin::tools
