// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/pixel_content.h"

#include <array>

#include "engine/error.h"

namespace ptin::tools {

namespace {

constexpr std::array<const char*, 4> kNames = {"height", "slope", "aspect", "hillshade"};

}  // namespace

void add_pixel_content(ask::Parameters& rows, PixelContentOptions& options) {
  rows.add("what", &options.what, "WHAT",
           "Rasters: height, slope, aspect (degrees clockwise from north) or hillshade of the "
           "triangle under the pixel's centre")
      .of({kNames.begin(), kNames.end()})
      .with_default();
  rows.add("slope-unit", &options.slope_unit, "UNIT",
           "degree or percent, of --what slope and of the field slope (default degree)")
      .of({"degree", "percent"});
  rows.add("azimuth", &options.azimuth, "A",
           "Hillshades: where the light comes from, in degrees clockwise from north (default 315)")
      .within({.least = 0, .most = 360});
  rows.add("altitude", &options.altitude, "A",
           "Hillshades: how high the light stands, in degrees (default 45)")
      .within({.least = 0, .most = 90});
}

PixelContent pixel_content_of(const PixelContentOptions& options, bool of_raster, bool has_slope) {
  PixelContent content;
  while (options.what != kNames.at(static_cast<std::size_t>(content.value)))
    content.value = static_cast<PixelValue>(static_cast<int>(content.value) + 1);
  if (!of_raster && content.value != PixelValue::kHeight) {
    throw Error(ErrorCode::invalid_argument,
                "is for rasters (.tif); triangles have the fields slope and aspect in .gpkg and "
                ".fgb",
                "--what");
  }
  if (!options.slope_unit.empty() && !has_slope && content.value != PixelValue::kSlope) {
    throw Error(ErrorCode::invalid_argument,
                "is for what has slopes: --what slope, or triangles in .gpkg and .fgb",
                "--slope-unit");
  }
  if ((options.azimuth || options.altitude) && content.value != PixelValue::kHillshade) {
    throw Error(ErrorCode::invalid_argument, "tells of the light; add --what hillshade",
                options.azimuth ? "--azimuth" : "--altitude");
  }
  content.in_percent = options.slope_unit == "percent";
  content.light = Light(options.azimuth.value_or(315), options.altitude.value_or(45));
  return content;
}

}  // namespace ptin::tools
