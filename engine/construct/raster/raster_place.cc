// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>
#include <vector>

#include <cpl_string.h>
#include <ogr_spatialref.h>

#include "engine/construct/grid/crs.h"
#include "engine/construct/grid/crs_beside.h"
#include "engine/construct/grid/dataset_crs.h"
#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/raster/tiff_keys.h"
#include "engine/error.h"
#include "engine/geometry/point.h"

namespace ptin {
namespace {

/// The name of an attribute without its variable's, and its value.
using Item = std::pair<std::string, std::string>;

std::vector<Item> items_of(GDALDataset& data) {
  std::vector<Item> items;
  const CPLStringList list(data.GetMetadata(), FALSE);
  for (int i = 0; i < list.size(); ++i) {
    const std::string_view text(list[i]);
    const std::size_t equals = text.find('=');
    const std::size_t hash = text.substr(0, equals).find('#');
    if (equals != std::string_view::npos && hash != std::string_view::npos) {
      items.emplace_back(text.substr(hash + 1, equals - hash - 1), text.substr(equals + 1));
    }
  }
  return items;
}

template <std::size_t N>
bool is_one_of(const std::string& text, const std::array<const char*, N>& words) {
  for (const char* const word : words) {
    if (EQUAL(text.c_str(), word)) {
      return true;
    }
  }
  return false;
}

/// "degree" where variables of coordinates are in degrees to the east and to the north; else "".
std::string plane_unit_of_items(GDALDataset& data) {
  // The spellings of CF, sections 4.1 and 4.2.
  constexpr std::array<const char*, 6> kEast = {"degrees_east", "degree_east", "degree_E",
                                                "degrees_E",    "degreeE",     "degreesE"};
  constexpr std::array<const char*, 6> kNorth = {"degrees_north", "degree_north", "degree_N",
                                                 "degrees_N",     "degreeN",      "degreesN"};
  bool is_east = false, is_north = false;
  for (const auto& [name, value] : items_of(data)) {
    is_east = is_east || (name == "units" && is_one_of(value, kEast));
    is_north = is_north || (name == "units" && is_one_of(value, kNorth));
  }
  return is_east && is_north ? "degree" : "";
}

/// Warns of a geoid or a vertical datum that is named by an attribute alone. The kind begins with
/// "crs_" (see warnings_that_count()).
void warn_of_vertical_items(GDALDataset& data, const std::string& path, SourceWarnings& warnings) {
  constexpr std::array<const char*, 6> kNames = {"geoid_name",     "geopotential_datum_name",
                                                 "vertical_datum", "vert_datum",
                                                 "vertical_crs",   "vertical_datum_name"};
  for (const auto& [name, value] : items_of(data)) {
    if (is_one_of(name, kNames) && !value.empty()) {
      warnings.add({"crs_vertical_in_words",
                    "the heights are told to be above '" + value + "' (" + name +
                        "), which is not used; name the vertical CRS with --vertical-crs",
                    path});
      return;
    }
  }
}

/// Whether a geotransform is stated. The identity means none where GDAL's drivers fill it in; a VRT has the one that is
/// written in it, or none.
bool has_geotransform(GDALDataset& data, std::array<double, 6>& t) {
  constexpr std::array<double, 6> kIdentity{0, 1, 0, 0, 0, 1};
  if (data.GetGeoTransform(t.data()) != CE_None) return false;
  const GDALDriver* const driver = data.GetDriver();
  return t != kIdentity || (driver != nullptr && EQUAL(driver->GetDescription(), "VRT"));
}

/// Refuses a raster without a geotransform that is placed otherwise, or that names a CRS; warns of any
/// other, which lies nowhere.
void describe_no_place(GDALDataset& data, const std::string& path, bool has_crs,
                       SourceWarnings& warnings) {
  const auto has = [&](const char* domain) {
    char** const items = data.GetMetadata(domain);
    return items != nullptr && items[0] != nullptr;
  };
  if (data.GetGCPCount() > 0) {
    refuse("this raster is placed by ground control points alone; warp it with 'gdalwarp' first",
           path);
  }
  if (has("RPC")) {
    refuse(
        "this raster is placed by rational polynomials (RPC) alone; warp it with 'gdalwarp -rpc "
        "-t_srs CRS' first",
        path);
  }
  if (has("GEOLOCATION")) {
    refuse(
        "this raster is placed by arrays of coordinates (GEOLOCATION) alone; warp it with "
        "'gdalwarp -geoloc -t_srs CRS' first",
        path);
  }
  if (has_crs) {
    refuse(
        "this raster names a CRS, but not where in it its pixels lie: it has no geotransform, or "
        "the one that means none (0, 1, 0, 0, 0, 1); state its corners with 'gdal_translate "
        "-a_ullr WEST NORTH EAST SOUTH'",
        path);
  }
  warnings.add({"no_georeference",
                "this raster does not say where it lies: x and y count its pixels, from the "
                "south-western one; state its corners and its CRS with 'gdal_translate -a_ullr "
                "WEST NORTH EAST SOUTH -a_srs CRS'",
                path});
}

/// The affine map of the file, turned so that both axes grow and samples stand at pixel centres.
/// GDAL's geotransform speaks of pixel corners whether the file calls its pixels areas or points.
void set_map(const std::array<double, 6>& t, const std::string& path, RasterShape& shape) {
  shape.georeferenced = true;
  shape.geotransform = t;
  if (!std::all_of(t.begin(), t.end(), [](double v) { return std::isfinite(v); }) || t[1] == 0 ||
      t[5] == 0) {
    refuse("this raster has an impossible geotransform", path);
  }
  const double skew = std::max(std::abs(t[2] / t[1]) * static_cast<double>(shape.height),
                               std::abs(t[4] / t[5]) * static_cast<double>(shape.width));
  if (skew > 1e-3) {
    refuse("this raster is rotated or sheared; make it north-up with 'gdalwarp' first", path);
  }
  shape.columns_from_east = t[1] < 0;
  shape.rows_from_south = t[5] > 0;
  const double west = shape.columns_from_east ? static_cast<double>(shape.width) - 0.5 : 0.5;
  const double south = shape.rows_from_south ? 0.5 : static_cast<double>(shape.height) - 0.5;
  shape.map = {t[0] + t[1] * west, t[3] + t[5] * south, std::abs(t[1]), std::abs(t[5])};
}

OGRAxisOrientation orientation_of(const OGRSpatialReference& srs, int axis) {
  OGRAxisOrientation orientation = OAO_Other;
  srs.GetAxis(nullptr, axis, &orientation);
  return orientation;
}

/// Refuses a CRS along whose axes x and y of the raster do not run in this order.
void check_axes(const OGRSpatialReference& srs, const std::string& path) {
  const std::vector<int>& mapping = srs.GetDataAxisToSRSAxisMapping();
  if (mapping.size() < 2 || srs.IsLocal() != 0) {
    return;
  }
  const auto axis_of = [&](int i) {
    return orientation_of(srs, std::abs(mapping[static_cast<std::size_t>(i)]) - 1);
  };
  const OGRAxisOrientation x = axis_of(0), y = axis_of(1);
  const auto is_of_y = [](OGRAxisOrientation o) { return o == OAO_North || o == OAO_South; };
  const auto is_of_x = [](OGRAxisOrientation o) { return o == OAO_East || o == OAO_West; };
  if (is_of_y(x) && is_of_x(y)) {
    refuse(
        "the first coordinate of this raster is a northing or a latitude, by the order of axes "
        "that "
        "it declares; bring x before y with 'gdalwarp', or state the CRS with 'gdal_edit.py "
        "-a_srs'",
        path);
  }
}

void warn_of_epoch(const OGRSpatialReference& srs, const std::string& path,
                   SourceWarnings& warnings) {
  if (const double epoch = srs.GetCoordinateEpoch(); epoch > 0) {
    char text[32];
    std::snprintf(text, sizeof text, "%.8g", epoch);
    warnings.add({"coordinate_epoch",
                  "the coordinates are of the epoch " + std::string(text) +
                      ", which a terrain does not keep; where centimetres matter, warp it to a CRS "
                      "that is fixed to its plate",
                  path});
  }
}

/// `plane` with the heights that keys declare, if they declare any.
std::string with_heights(const DeclaredCrs& declared, const std::string& path,
                         const std::string& plane) try {
  if (!resolve_crs(declared.crs, "", declared.vertical_crs).vertical_known) {
    return plane;
  }
  return declared.vertical_crs.empty() ? with_third_axis(plane)
                                       : resolve_crs(plane, "", declared.vertical_crs).wkt;
} catch (const Error& e) {
  throw Error(e.code(), e.message(), e.context().empty() ? path : e.context());
}

/// Looks at the keys of a GeoTIFF for what GDAL passes over: codes that it does not know, and a
/// vertical part in words.
void follow_keys(GDALDataset& data, const OGRSpatialReference* srs, const std::string& path,
                 RasterShape& shape, SourceWarnings& warnings) {
  const bool is_known = srs != nullptr && (srs->IsProjected() != 0 || srs->IsGeographic() != 0);
  const bool is_solid = is_known && (srs->IsCompound() != 0 || srs->GetAxesCount() > 2);
  if (is_solid || !EQUAL(data.GetDriverName(), "GTiff")) {
    return;
  }
  const GeoTiffKeys keys = keys_of_tiff(path);
  if (keys.directory.empty() || (is_known && !tell_of_heights(keys))) {
    return;
  }
  const DeclaredCrs declared = crs_of_keys(keys);
  shape.unit = shape.unit.empty() ? declared.units.heights : shape.unit;
  if (!is_known) {
    shape.crs = declared.crs;
    shape.plane_unit = declared.units.plane;
  }
  if (!shape.crs.empty() && !declared.crs.empty()) {
    shape.crs = with_heights(declared, path, shape.crs);
  }
  for (SourceWarning warning : declared.warnings) {
    if (!is_known || !declared.crs.empty()) {
      warning.file = path;
      warnings.add(std::move(warning));
    }
  }
}

}  // namespace

void describe_place(GDALDataset& data, const std::string& path, RasterShape& shape,
                    SourceWarnings& warnings) {
  shape.width = data.GetRasterXSize();
  shape.height = data.GetRasterYSize();
  const char* const pixels = data.GetMetadataItem(GDALMD_AREA_OR_POINT);
  shape.is_point = pixels != nullptr && EQUAL(pixels, GDALMD_AOP_POINT);
  if (shape.width - 1 > kGridMax || shape.height - 1 > kGridMax) {
    refuse("this raster has more than 2^30 columns or rows, which is the limit of the grid", path);
  }
  const GdalSession session;
  const OGRSpatialReference* srs = data.GetSpatialRef();
  const bool has_crs = srs != nullptr && !srs->IsEmpty();
  std::array<double, 6> t{};
  if (!has_geotransform(data, t)) {
    describe_no_place(data, path, has_crs, warnings);
  } else {
    set_map(t, path, shape);
  }
  shape.crs = declared_crs(data, srs, session, path, warnings);
  follow_keys(data, srs, path, shape, warnings);
  if (shape.crs.empty() && shape.georeferenced) {
    take_crs_beside(path, shape.crs, warnings);  // GDAL looks for it beside few formats.
  }
  shape.plane_unit = shape.plane_unit.empty() ? plane_unit_of_items(data) : shape.plane_unit;
  if (!has_crs || (srs->IsCompound() == 0 && srs->GetAxesCount() < 3)) {
    warn_of_vertical_items(data, path, warnings);
  }
  if (has_crs) {
    check_axes(*srs, path);
    warn_of_epoch(*srs, path, warnings);
  }
}

}  // namespace ptin
