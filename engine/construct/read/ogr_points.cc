// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/ogr_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "engine/construct/grid/dataset_crs.h"
#include "engine/construct/grid/depth_names.h"
#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/read/column_names.h"
#include "engine/construct/read/dxf_units.h"
#include "engine/construct/read/hidden_features.h"
#include "engine/construct/read/layer_choice.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// The unit of depths that the header of a chart states (S-57, DSPM_DUNI); "" where it is silent.
std::string unit_of_depths(GDALDataset& data) {
  constexpr std::array<const char*, 5> kUnitsOfDepths = {"", "metres", "fathoms and feet", "feet",
                                                         "fathoms and fractions"};
  OGRLayer* const header = data.GetLayerByName("DSID");
  if (header == nullptr) {
    return "";
  }
  header->ResetReading();
  const OGRFeatureUniquePtr feature(header->GetNextFeature());
  const int field = feature == nullptr ? -1 : feature->GetFieldIndex("DSPM_DUNI");
  const int code = field < 0 ? 0 : feature->GetFieldAsInteger(field);
  return code > 0 && code < 5 ? kUnitsOfDepths[static_cast<std::size_t>(code)] : "";
}

/// Refuses the soundings of a nautical chart (S-57), and attributes of one that hold depths. Warns of
/// any other layer, or attribute, that has a name of depths.
/// @param z_field  The attribute that holds heights; "" for the z of points.
/// @throws Error invalid_argument  as above
void refuse_depths(GDALDataset& data, OGRLayer& layer, const std::string& z_field,
                   const std::string& path, SourceWarnings& warnings) {
  const std::string name = z_field.empty() ? layer.GetName() : z_field;
  const std::string what = z_field.empty() ? "the layer '" : "the attribute '";
  if (!is_name_of_depths(name)) {
    return;
  }
  if (!EQUAL(data.GetDriverName(), "S57")) {
    warnings.add(
        {.kind = "depths",
         .message = what + name +
                    "' has a name of depths, and is taken for heights, which grow upwards; "
                    "if it grows downwards, turn the sign of its values first",
         .file = path});
    return;
  }
  const std::string unit = unit_of_depths(data);
  refuse(
      what + name + "' of this chart holds depths" + (unit.empty() ? "" : " in " + unit) +
          ", which grow downwards, and a terrain has heights; " +
          (z_field.empty()
               ? "turn their sign with 'ogr2ogr -f CSV -lco GEOMETRY=AS_XY HEIGHTS.csv FILE -oo "
                 "SPLIT_MULTIPOINT=ON -oo ADD_SOUNDG_DEPTH=ON -sql \"SELECT -1 * DEPTH AS z FROM "
                 "SOUNDG\"', and name the CRS of the CSV by --a-srs EPSG:4326"
               : "turn their sign with 'ogr2ogr -sql \"SELECT -1 * " + z_field + " AS z, * FROM " +
                     layer.GetName() + "\" HEIGHTS.gpkg FILE'"),
      path);
}

constexpr std::size_t kBatchPoints = 4096;
/// Less means no value, by the specification of shapefiles.
constexpr double kLeastHeight = -1e38;

bool has_geometry(GDALDataset& data) {
  for (int i = 0; i < data.GetLayerCount(); ++i) {
    if (data.GetLayer(i)->GetGeomType() != wkbNone) {
      return true;
    }
  }
  return false;
}

bool is_numeric(OGRFieldType type) {
  return type == OFTReal || type == OFTInteger || type == OFTInteger64;
}

/// The names of the attributes that hold numbers, in quotes; "" where none does.
std::string numbers_in(OGRLayer& layer) {
  OGRFeatureDefn& definition = *layer.GetLayerDefn();
  std::string names;
  for (int i = 0; i < definition.GetFieldCount(); ++i) {
    if (is_numeric(definition.GetFieldDefn(i)->GetType())) {
      names += (names.empty() ? "'" : ", '") +
               std::string(definition.GetFieldDefn(i)->GetNameRef()) + "'";
    }
  }
  return names;
}

}  // namespace

struct OgrPoints::Layer {
  GDALDatasetUniquePtr data;
  OGRLayer* layer = nullptr;
  int z_field = -1;
  int altitude_mode = -1;  ///< The attribute in which KML says what its heights are above.
  std::optional<HiddenFeatures> hidden;

  std::string crs;

  void open(const std::string& path, const PointChoice& choice, SourceWarnings& warnings);
  void choose_height(const std::string& path, const std::string& field);
};

void OgrPoints::Layer::open(const std::string& path, const PointChoice& choice,
                            SourceWarnings& warnings) {
  const GdalSession session;
  const ReportedVerticalParts vertical;
  data.reset(
      GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  if (data == nullptr) {
    VSIStatBufL status;
    if (VSIStatL(path.c_str(), &status) != 0) {
      throw Error(ErrorCode::not_found, "there is no such file of points", path);
    }
    throw Error(ErrorCode::invalid_argument,
                session.explain("this is no vector data that OGR reads"), path);
  }
  layer = &choose_layer(*data, {LayerKind::kPoints, choice.layer}, path);
  crs = declared_crs(*data, layer->GetSpatialRef(), session, path, warnings);
  choose_height(path, choice.z_field);
  if (z_field < 0 && EQUAL(data->GetDriverName(), "LIBKML")) {
    altitude_mode = layer->GetLayerDefn()->GetFieldIndex("altitudeMode");
  }
  hidden.emplace(*data, *layer);
  session.tell_warnings(path, warnings);
}

void OgrPoints::Layer::choose_height(const std::string& path, const std::string& field) {
  const auto refuse = [&](const std::string& sentence) {
    throw Error(ErrorCode::invalid_argument, sentence, path);
  };
  if (field.empty()) {
    const OGRwkbGeometryType type = layer->GetGeomType();
    if (wkbFlatten(type) != wkbUnknown && !wkbHasZ(type)) {
      refuse("the points of layer '" + std::string(layer->GetName()) +
             (numbers_in(*layer).empty()
                  ? "' have no z, and no attribute holds numbers that --z-field could name; give "
                    "points with z, or a text with x, y and z in each line (.xyz, .csv)"
                  : "' have no z; name the attribute that holds their height with --z-field"));
    }
    return;
  }
  OGRFeatureDefn* definition = layer->GetLayerDefn();
  z_field = definition->GetFieldIndex(field.c_str());
  if (z_field < 0) {
    const std::string names = numbers_in(*layer);
    refuse("there is no attribute '" + field + "'; " +
           (names.empty() ? "none holds numbers" : "numbers are in " + names));
  }
  if (!is_numeric(definition->GetFieldDefn(z_field)->GetType())) {
    refuse("the attribute '" + field + "' holds no numbers");
  }
}

OgrPoints::OgrPoints(std::string path, const PointChoice& choice)
    : path_(std::move(path)), layer_(std::make_unique<Layer>()) {
  layer_->open(path_, choice, warnings_);
  const GdalSession session;
  refuse_depths(*layer_->data, *layer_->layer, choice.z_field, path_, warnings_);
  facts_.crs = layer_->crs;
  facts_.units.heights = unit_of_column(choice.z_field);
  if (facts_.units.heights == "degree") {
    facts_.units.heights.clear();
  }
  if (EQUAL(layer_->data->GetDriverName(), "DXF") && !path_.starts_with("/vsi")) {
    note_unit(unit_of_dxf(path_));
    note_geodata();
  }
  if (layer_->layer->GetLayerDefn()->GetGeomFieldCount() > 1) {
    warnings_.add({.kind = "several_geometries",
                   .message = "the layer has several geometries a feature, and only the first of "
                              "them is read; give a layer of the one that is meant",
                   .file = path_});
  }
  if (layer_->layer->TestCapability(OLCFastFeatureCount) != 0) {
    total_ = static_cast<std::uint64_t>(std::max<GIntBig>(layer_->layer->GetFeatureCount(), 0));
  }
  layer_->layer->ResetReading();
}

OgrPoints::~OgrPoints() {
  const GdalSession session;
  layer_.reset();
}

bool OgrPoints::reads(const std::string& path) {
  const GdalSession session;
  const auto opened = [&](unsigned kind) {
    return GDALDatasetUniquePtr(GDALDataset::Open(path.c_str(), kind | GDAL_OF_READONLY));
  };
  const GDALDatasetUniquePtr layers = opened(GDAL_OF_VECTOR);
  if (layers == nullptr || layers->GetLayerCount() == 0) {
    return false;
  }
  const GDALDatasetUniquePtr raster = opened(GDAL_OF_RASTER);
  if (raster == nullptr) {
    return true;
  }
  // A file of several rasters has no band itself, and drivers find tables without geometry in it.
  char** const inside = raster->GetMetadata("SUBDATASETS");
  const bool holds_rasters =
      raster->GetRasterCount() > 0 || (inside != nullptr && inside[0] != nullptr);
  return !holds_rasters || (raster->GetRasterCount() == 0 && has_geometry(*layers));
}

Decimal OgrPoints::number(double value, const char* role) const {
  if (std::abs(value) < 1e15) {
    return decimal_of(value);
  }
  throw Error(ErrorCode::invalid_argument,
              std::string("the ") + role + " of this point is " +
                  (std::isnan(value) ? "NaN" : "infinite or 10^15 and more"),
              path_ + ": feature " + std::to_string(feature_));
}

void OgrPoints::add_point(const void* any, double field_height, std::vector<SourcePoint>& batch) {
  const auto& point = *static_cast<const OGRPoint*>(any);
  if (point.IsEmpty() != 0) {
    left_out_.add(LeftOutReason::kNoHeight);
    return;
  }
  if (layer_->z_field < 0 && point.Is3D() == 0) {
    throw Error(ErrorCode::invalid_argument,
                "this point has no z; name the attribute that holds heights with --z-field",
                path_ + ": feature " + std::to_string(feature_));
  }
  const double height = layer_->z_field < 0 ? point.getZ() : field_height;
  if (height < kLeastHeight && std::isfinite(height)) {
    left_out_.add(LeftOutReason::kNoHeight);
    return;
  }
  batch.push_back({number(point.getX(), "x"), number(point.getY(), "y"), number(height, "height")});
}

/// Takes the unit that a DXF declares. Many programs write inches for want of knowing.
void OgrPoints::note_unit(const std::string& unit) {
  if (unit == "inch") {
    warnings_.add({.kind = "dxf_inches",
                   .message = "the file says that it is in inches ($INSUNITS), which is not used, "
                              "since many programs write it whatever the unit is; say with --a-srs "
                              "in which CRS the points are",
                   .file = path_});
    return;
  }
  facts_.units = {unit, facts_.units.heights.empty() ? unit : facts_.units.heights};
}

/// Warns of the CRS that a DXF may have, and OGR passes over.
void OgrPoints::note_geodata() {
  if (has_geodata(path_)) {
    warnings_.add({.kind = "dxf_geodata",
                   .message =
                       "the drawing tells its CRS (GEODATA), which is not read; name it with "
                       "--a-srs, or lay a .prj beside the file",
                   .file = path_});
  }
}

/// Warns of a feature whose z is no height of its own.
void OgrPoints::note_altitude_mode(const void* any) {
  const auto& feature = *static_cast<const OGRFeature*>(any);
  const int field = layer_->altitude_mode;
  if (field < 0 || feature.IsFieldSetAndNotNull(field) == 0) {
    return;
  }
  const std::string mode = feature.GetFieldAsString(field);
  if (!mode.empty() && mode != "absolute") {
    warnings_.add(
        {.kind = "altitude_mode",
         .message = "the altitudeMode of points is " + mode +
                    ", and their z is taken for a height above the sea all the same; leave "
                    "these points out, or give them heights",
         .file = path_,
         .subject = mode,
         .count = 1});
  }
}

void OgrPoints::add_feature(void* any, std::vector<SourcePoint>& batch) {
  auto& feature = *static_cast<OGRFeature*>(any);
  const OGRGeometry* geometry = feature.GetGeometryRef();
  if (geometry == nullptr || geometry->IsEmpty() != 0 || layer_->hidden->holds(feature) ||
      (layer_->z_field >= 0 && feature.IsFieldSetAndNotNull(layer_->z_field) == 0)) {
    left_out_.add(LeftOutReason::kNoHeight);
    return;
  }
  note_altitude_mode(&feature);
  const double height = layer_->z_field < 0 ? 0.0 : feature.GetFieldAsDouble(layer_->z_field);
  switch (wkbFlatten(geometry->getGeometryType())) {
    case wkbPoint:
      add_point(geometry->toPoint(), height, batch);
      return;
    case wkbMultiPoint:
      for (const OGRPoint* point : *geometry->toMultiPoint()) {
        add_point(point, height, batch);
      }
      return;
    default:
      throw Error(ErrorCode::invalid_argument,
                  std::string("this is a ") + geometry->getGeometryName() + ", not a point",
                  path_ + ": feature " + std::to_string(feature_));
  }
}

bool OgrPoints::next(std::vector<SourcePoint>& batch) {
  batch.clear();
  const GdalSession session;
  while (batch.size() < kBatchPoints) {
    const OGRFeatureUniquePtr feature(layer_->layer->GetNextFeature());
    if (feature == nullptr) {
      if (session.failed()) {
        throw Error(ErrorCode::io_error, session.explain("cannot be read on"), path_);
      }
      break;
    }
    feature_ = feature->GetFID();
    ++read_;
    add_feature(feature.get(), batch);
  }
  return !batch.empty();
}

}  // namespace ptin
