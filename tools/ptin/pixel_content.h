// SPDX-License-Identifier: GPL-3.0-or-later
//
// The options of export that tell what a raster holds: heights, slopes, aspects, a hillshade.
#pragma once

#include <optional>
#include <string>

#include "tools/ask/parameter.h"
#include "tools/export/raster_export.h"

namespace ptin::tools {

struct PixelContentOptions {
  std::string what = "height";
  std::string slope_unit;
  std::optional<double> azimuth, altitude;
};

void add_pixel_content(ask::Parameters& rows, PixelContentOptions& options);

/// What was asked for.
/// @param of_raster  The output is a raster.
/// @param has_slope  Its features have a field `slope`.
/// @throws Error invalid_argument  an option that says nothing of this output; no number of degrees
[[nodiscard]] PixelContent pixel_content_of(const PixelContentOptions& options, bool of_raster,
                                            bool has_slope);

/// "degree" or "percent".
[[nodiscard]] inline std::string slope_unit_of(const PixelContentOptions& options) {
  return options.slope_unit.empty() ? "degree" : options.slope_unit;
}

}  // namespace ptin::tools
