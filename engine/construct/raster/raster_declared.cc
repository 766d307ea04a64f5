// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_declared.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <vector>

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_rat.h>

#include "engine/construct/grid/dataset_crs.h"
#include "engine/construct/grid/depth_names.h"
#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/raster/raster_header.h"
#include "engine/construct/raster/raster_place.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"

namespace ptin {
namespace {

constexpr const char* kTurn =
    "; turn the sign of the values, as with 'gdal_calc.py -A FILE --calc=-A --outfile=HEIGHTS.tif'";

std::string item(GDALRasterBand& band, const char* name) {
  const char* const value = band.GetMetadataItem(name);
  return value == nullptr ? "" : value;
}

/// Refuses a band that says that its values grow downwards: by the attribute `positive`, which is
/// "down", or by a `standard_name` of depths, as the conventions of netCDF have them. Warns of one
/// that has merely a name of depths. A band whose `positive` is "up" has heights, whatever its name.
/// @throws Error invalid_argument  as above
void refuse_depths(GDALRasterBand& band, const std::string& path, SourceWarnings& warnings) {
  const std::string positive = item(band, "positive");
  if (EQUAL(positive.c_str(), "up")) {
    return;
  }
  if (EQUAL(positive.c_str(), "down")) {
    refuse("the values are positive downwards (positive = '" + positive +
               "'): they are depths, and a terrain has heights" + kTurn,
           path);
  }
  const std::string standard_name = item(band, "standard_name");
  if (is_name_of_depths(standard_name)) {
    refuse("the values are depths, by their standard_name '" + standard_name +
               "', and a terrain has heights" + kTurn,
           path);
  }
  for (const std::string& name : {item(band, "long_name"), item(band, "NETCDF_VARNAME"),
                                  std::string(band.GetDescription())}) {
    if (is_name_of_depths(name)) {
      warnings.add({"depths",
                    "the values have a name of depths, '" + name +
                        "', and are taken for heights, which grow upwards; if they grow downwards" +
                        std::string(kTurn).replace(0, 1, ","),
                    path});
      return;
    }
  }
}

/// The names of the rasters in a file that holds several. Drivers list them as a whole; not all answer
/// for a single one.
std::vector<std::string> subdatasets_of(GDALDataset& data) {
  std::vector<std::string> names;
  const CPLStringList list(data.GetMetadata("SUBDATASETS"), FALSE);
  for (int i = 1;; ++i) {
    const char* name = list.FetchNameValue(("SUBDATASET_" + std::to_string(i) + "_NAME").c_str());
    if (name == nullptr) {
      return names;
    }
    names.emplace_back(name);
  }
}

bool is_alpha(GDALRasterBand& band) { return band.GetColorInterpretation() == GCI_AlphaBand; }

/// Before GDAL 3.7 there is no type for signed bytes: they are handed out as 0 to 255.
bool holds_signed_bytes(GDALRasterBand& band) {
  const char* pixel_type = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  return band.GetRasterDataType() == GDT_Byte && pixel_type != nullptr &&
         EQUAL(pixel_type, "SIGNEDBYTE");
}

/// True where a table of attributes or a list of names gives the values other meanings than heights.
bool names_classes(GDALRasterBand& band) {
  const CPLStringList names(band.GetCategoryNames(), FALSE);
  for (int i = 0; i < names.size(); ++i) {
    if (names[i][0] != '\0') {
      return true;
    }
  }
  const GDALRasterAttributeTable* table = band.GetDefaultRAT();
  return table != nullptr && table->GetColOfUsage(GFU_Name) >= 0;
}

void warn_of_classes(GDALRasterBand& band, const std::string& path, SourceWarnings& warnings) {
  if (band.GetColorInterpretation() == GCI_PaletteIndex || band.GetColorTable() != nullptr) {
    warnings.add(
        {"palette",
         "the values are numbers of a colour table, and are taken for heights; if they are "
         "none, name the raster that this picture was made of",
         path});
  } else if (names_classes(band)) {
    warnings.add(
        {"classes",
         "the values are numbers of classes that have names, and are taken for heights; if "
         "they are none, name another raster",
         path});
  }
}

void describe_values(GDALRasterBand& band, const std::string& path, RasterShape& shape) {
  const GDALDataType type = band.GetRasterDataType();
  shape.type_name = GDALGetDataTypeName(type);
  if (GDALDataTypeIsComplex(type)) {
    refuse("this raster holds complex numbers (" + shape.type_name + "), not heights", path);
  }
  shape.stored = {type, holds_signed_bytes(band),
                  significant_bits_of(type, band.GetMetadataItem("NBITS", "IMAGE_STRUCTURE"))};
  shape.scale = band.GetScale();
  shape.offset = band.GetOffset();
  if (!std::isfinite(shape.scale) || !std::isfinite(shape.offset) || shape.scale == 0.0) {
    refuse("the raster's scale must be finite and not 0, and its offset finite", path);
  }
  const bool scaled = shape.scale != 1.0 || shape.offset != 0.0;
  const bool fits_int32 =
      type == GDT_Byte || type == GDT_UInt16 || type == GDT_Int16 || type == GDT_Int32;
  if (fits_int32 && shape.scale > 0.0) {
    shape.raw = RawType::kInt32;
  } else if (type == GDT_Float32 && !scaled) {
    shape.raw = RawType::kFloat32;
  } else {
    shape.raw = RawType::kFloat64;
  }
  // The range of integers is checked here, once for all; floats are checked one by one
  // (check_heights).
  const double largest = std::ldexp(1.0, type == GDT_Byte ? 8 : type == GDT_Int32 ? 31 : 16);
  if (shape.raw == RawType::kInt32 &&
      std::abs(shape.scale) * largest + std::abs(shape.offset) > FLT_MAX) {
    refuse("the raster's scale or offset is so large that heights may be beyond 3.4e38", path);
  }
  shape.unit = band.GetUnitType();
  band.GetBlockSize(&shape.block[0], &shape.block[1]);
}

}  // namespace

GDALDatasetUniquePtr open_raster(const std::string& path, SourceWarnings& warnings) {
  const GdalSession session;
  const ReportedVerticalParts vertical;
  static constexpr unsigned kFlags = GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR;
  GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str(), kFlags));
  if (data != nullptr) {
    session.tell_warnings(path, warnings);
    return data;
  }
  VSIStatBufL status;
  if (VSIStatL(path.c_str(), &status) != 0) {
    throw Error(ErrorCode::not_found, session.explain("there is no such raster"), path);
  }
  if (VSI_ISDIR(status.st_mode)) {
    refuse(
        "this folder holds no file *.las or *.laz, and is no raster or layer that GDAL reads; "
        "name the files of the source, or the folder that they are in",
        path);
  }
  require_readable(path);
  refuse(session.explain("this is neither a raster nor a layer that GDAL reads; LAS, text and "
                         "TINs are known by their names: .las, .laz, .csv, .xyz, .txt, .ply, .obj, "
                         ".2dm, .xml"),
         path);
}

RasterBands bands_of(GDALDataset& data, const std::string& path, bool is_overridden) {
  // Many a question has GDAL read the CRS, and keep it as it is then.
  const ReportedVerticalParts vertical;
  const int count = data.GetRasterCount();
  if (count == 0) {
    const std::vector<std::string> inside = subdatasets_of(data);
    refuse(inside.empty() ? std::string("this raster has no band")
                          : "this file holds several rasters; name one, such as " + inside.front(),
           path);
  }
  RasterBands bands;
  for (int i = 1; i <= count && count <= 2; ++i) {
    GDALRasterBand* band = data.GetRasterBand(i);
    if (count == 2 && bands.alpha == nullptr && is_alpha(*band)) {
      bands.alpha = band;
    } else if (bands.height == nullptr) {
      bands.height = band;
    } else {
      bands.height = nullptr;
      break;
    }
  }
  if (bands.height == nullptr) {
    refuse("this raster has " + std::to_string(count) +
               " bands where one of heights is expected; take it out with "
               "'gdal_translate -b NUMBER'",
           path);
  }
  // The mask of a nodata value says no more than the value, which is compared anyway, but where that is
  // the whole dataset's (NODATA_VALUES), which no band states. GDAL takes an alpha band for a mask
  // only where samples are Byte or UInt16, so that band is looked at itself.
  const int flags = bands.height->GetMaskFlags();
  const bool is_of_value =
      (flags & GMF_NODATA) != 0 && (is_overridden || (flags & GMF_PER_DATASET) == 0);
  if (!is_of_value && (flags & (GMF_ALL_VALID | GMF_ALPHA)) == 0) {
    bands.mask = bands.height->GetMaskBand();
  }
  return bands;
}

std::optional<double> declared_nodata(GDALRasterBand& band) {
  int has = 0;
  double value = 0.0;
  switch (band.GetRasterDataType()) {
    case GDT_Int64:
      value = static_cast<double>(band.GetNoDataValueAsInt64(&has));
      break;
    case GDT_UInt64:
      value = static_cast<double>(band.GetNoDataValueAsUInt64(&has));
      break;
    default:
      value = band.GetNoDataValue(&has);
  }
  return has != 0 ? std::optional<double>(value) : std::nullopt;
}

RasterShape shape_of(GDALDataset& data, GDALRasterBand& band, const std::string& path,
                     SourceWarnings& warnings) {
  const ReportedVerticalParts vertical;
  RasterShape shape;
  check_header(data, path, warnings);
  describe_values(band, path, shape);
  describe_place(data, path, shape, warnings);
  shape.unit = shape.unit.empty() ? height_unit_of_prj(data) : shape.unit;
  warn_of_classes(band, path, warnings);
  refuse_depths(band, path, warnings);
  if (const std::vector<std::string> inside = subdatasets_of(data); inside.size() > 1) {
    warnings.add({"several_rasters",
                  "this file holds " + std::to_string(inside.size()) +
                      " rasters, of which the first is read; another one is named as " +
                      inside.back(),
                  path});
  }
  return shape;
}

}  // namespace ptin
