// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/dataset_crs.h"

#include <string_view>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/crs_in_text.h"
#include "engine/construct/grid/gdal_session.h"
#include "engine/number.h"

namespace ptin {

namespace {

/// True for a message of GDAL's that is about a CRS.
bool is_about_crs(const std::string& message) {
  const CPLString text(message);
  for (const char* const word :
       {"PROJ:", "CRS", "SRS", "EPSG", "coordinate system", "projection"}) {
    if (text.ifind(word) != std::string::npos) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::string declared_crs(GDALDataset& data, const OGRSpatialReference* srs,
                         const GdalSession& opening, const std::string& path,
                         SourceWarnings& warnings) {
  const bool is_none = srs == nullptr || srs->IsEmpty();
  std::string text = is_none ? crs_in_text(data) : "";
  // GeoJSON whose CRS is not understood is given that of the standard instead.
  const bool is_geojson = EQUAL(data.GetDriverName(), "GeoJSON");
  if (std::string named = crs_in_geojson(data); !named.empty() && !is_crs(named)) {
    return named;
  }
  const bool is_lost = is_none && text.empty() && is_about_crs(opening.first_failure());
  if (opening.failed() && (is_geojson || is_lost)) {
    warnings.add(
        {"crs_not_understood",
         opening.explain("its CRS is not one that GDAL understands; the terrain is without "
                         "it; name it by --a-srs"),
         path});
    return "";
  }
  if (is_none) {
    return text;
  }
  if (srs->GetAuthorityCode(nullptr) == nullptr && srs->GetName() != nullptr &&
      STARTS_WITH_CI(srs->GetName(), "Undefined ")) {
    return "";
  }
  warn_of_shift(prj_of(data), path, warnings);
  return wkt2_of(*srs);
}

std::string with_third_axis(const std::string& plane) {
  const GdalSession session;
  OGRSpatialReference srs;
  const bool is_made =
      srs.importFromWkt(plane.c_str()) == OGRERR_NONE && srs.PromoteTo3D(nullptr) == OGRERR_NONE;
  return is_made ? wkt2_of(srs) : plane;
}

std::string height_unit_of_prj(GDALDataset& data) {
  const CPLStringList lines(CSLTokenizeString2(prj_of(data).c_str(), "\r\n", 0));
  for (int i = 0; i < lines.size(); ++i) {
    const CPLStringList words(CSLTokenizeString2(lines[i], " \t", 0));
    if (words.size() > 1 && EQUAL(words[0], "Zunits") && !EQUAL(words[1], "NO")) {
      std::string_view beginning = words[1];
      const bool is_number = take_number<double>(beginning).value_or(0.0) != 0.0;
      return is_number ? std::string("Zunits ") + words[1] : std::string(words[1]);
    }
  }
  return "";
}

void warn_of_shift(const std::string& text, const std::string& path, SourceWarnings& warnings) {
  const std::size_t name = CPLString(text).ifind("\"Vertical_Shift\"");
  const std::size_t comma = name == std::string::npos ? name : text.find(',', name);
  const std::size_t begin = text.find_first_not_of(", ", comma);
  const std::string number =
      begin == std::string::npos  // WKT2 has a comma and a unit behind the number
          ? ""
          : text.substr(begin, text.find_first_of(",]", begin) - begin);
  std::string_view beginning = number;
  if (take_number<double>(beginning).value_or(0.0) != 0.0) {
    warnings.add({"crs_vertical_shift",
                  "its vertical CRS shifts heights by " + number +
                      " (Vertical_Shift), which is not applied: heights are taken as they are, in "
                      "the vertical CRS without it; add it to the heights first where it matters",
                  path});
  }
}

}  // namespace ptin
