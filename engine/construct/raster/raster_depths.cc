// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_depths.h"

#include "engine/construct/grid/depth_names.h"
#include "engine/error.h"

namespace ptin {

namespace {

constexpr const char* kTurn =
    "; turn the sign of the values, as with 'gdal_calc.py -A FILE --calc=-A --outfile=HEIGHTS.tif'";

std::string item(GDALRasterBand& band, const char* name) {
  const char* const value = band.GetMetadataItem(name);
  return value == nullptr ? "" : value;
}

}  // namespace

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

}  // namespace ptin
