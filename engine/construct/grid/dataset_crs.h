// SPDX-License-Identifier: GPL-3.0-or-later
//
// The CRS that a dataset of GDAL's declares, also where GDAL does not say so by itself.
#pragma once

#include <string>

#include <cpl_conv.h>

#include "engine/construct/grid/source_warning.h"

class GDALDataset;
class OGRSpatialReference;

namespace ptin {

class GdalSession;

/// Has GDAL give the vertical parts of CRSs that some of its drivers leave out unless they are
/// asked: those of GeoTIFF 1.0, of DTED, SRTM and their like, and of GML. The options are this
/// thread's alone, and as before when the scope ends. To be there while a file is opened and while
/// its CRS is first asked for, which any question may do.
class ReportedVerticalParts {
 public:
  ReportedVerticalParts()
      : geotiff_("GTIFF_REPORT_COMPD_CS", "YES", false),
        grids_("REPORT_COMPD_CS", "YES", false),
        gml_("GML_REPORT_COMPD_CS", "YES", false) {}

 private:
  CPLConfigOptionSetter geotiff_, grids_, gml_;
};

/// The CRS as WKT2; "" where there is none, or one of those by which a GeoPackage says that nothing is
/// known ("Undefined Cartesian SRS"). Where GDAL understands none, but the dataset or a file beside it
/// names one: that text, which resolve_source_crs() warns of.
/// @param srs       That of the dataset or of the layer that is read; null where GDAL knows none.
/// @param opening   That in which the dataset was opened.
/// @param warnings  Receives what the text of a CRS says and GDAL passes over.
[[nodiscard]] std::string declared_crs(GDALDataset& data, const OGRSpatialReference* srs,
                                       const GdalSession& opening, const std::string& path,
                                       SourceWarnings& warnings);

/// A CRS with heights above its ellipsoid, in metres; the same text where there is no such CRS.
[[nodiscard]] std::string with_third_axis(const std::string& plane);

/// The unit of heights in the .prj of a dataset (`Zunits` of old ones, as "FEET"); "" for none.
[[nodiscard]] std::string height_unit_of_prj(GDALDataset& data);

/// Warns where the text of a CRS shifts its heights (`Vertical_Shift`, which ESRI writes): nothing is
/// shifted.
void warn_of_shift(const std::string& text, const std::string& path, SourceWarnings& warnings);

}  // namespace ptin
