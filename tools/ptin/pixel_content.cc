// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/pixel_content.h"

#include <array>
#include <cmath>

#include <CLI/CLI.hpp>

#include "engine/error.h"

namespace ptin::tools {

namespace {

constexpr std::array<const char*, 4> kNames = {"height", "slope", "aspect", "hillshade"};

/// @throws Error invalid_argument  not from `least` to `most`
double degrees_in(double value, double least, double most, const char* option) {
  if (value >= least && value <= most) return value;
  throw Error(ErrorCode::invalid_argument,
              "must be from " + std::to_string(static_cast<int>(least)) + " to " +
                  std::to_string(static_cast<int>(most)) + " degrees",
              option);
}

}  // namespace

void add_pixel_content_options(CLI::App& app, PixelContentOptions& options) {
  app.add_option(
         "--what", options.what,
         "Rasters: height, slope, aspect (degrees clockwise from north) or hillshade of the "
         "triangle under the pixel's centre")
      ->type_name("WHAT")
      ->check(CLI::IsMember(std::vector<std::string>(kNames.begin(), kNames.end())))
      ->capture_default_str();
  app.add_option("--slope-unit", options.slope_unit,
                 "degree or percent, of --what slope and of the field slope (default degree)")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"degree", "percent"}));
  app.add_option("--azimuth", options.azimuth,
                 "Hillshades: where the light comes from, in degrees clockwise from north (default "
                 "315)")
      ->type_name("A");
  app.add_option("--altitude", options.altitude,
                 "Hillshades: how high the light stands, in degrees (default 45)")
      ->type_name("A");
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
  content.light = Light(degrees_in(options.azimuth.value_or(315), 0, 360, "--azimuth"),
                        degrees_in(options.altitude.value_or(45), 0, 90, "--altitude"));
  return content;
}

}  // namespace ptin::tools
