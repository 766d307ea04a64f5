// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a file keeps of the raster that it is built from, beside the heights of samples.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "storage/floor_facts.h"

namespace ptin {

/// Enough to write the raster again, where nothing is lost.
struct KeptRaster {
  SourceNumber number = SourceNumber::kUnknown;
  std::optional<double> nodata;
  /// As the raster states it; none: it states none.
  std::optional<std::array<double, 6>> geotransform;
  bool is_point = false;  ///< It calls its pixels points (AREA_OR_POINT).
  /// The first thing of the raster that does not come back bit for bit, as the subject of a sentence;
  /// empty: all do.
  std::string lost;
};

}  // namespace ptin
