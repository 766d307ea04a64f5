// SPDX-License-Identifier: GPL-3.0-or-later
//
// GeoTIFF keys, as LAS holds them outside of a TIFF: what they say of the CRS and of units.
#pragma once

#include <string>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"

namespace ptin {

/// The contents of the tags GeoKeyDirectory, GeoDoubleParams and GeoAsciiParams, as they are.
struct GeoTiffKeys {
  std::vector<unsigned char> directory, doubles, text;
};

/// A CRS and units, as a source declares them.
struct DeclaredCrs {
  std::string crs;           ///< Anything that GDAL understands; "" for none.
  std::string vertical_crs;  ///< Likewise, where it is apart from `crs`.
  DeclaredUnits units;       ///< Units that are declared beside these.
  /// Warnings of keys that nobody understands or that contradict others. They name no file; kinds
  /// "crs_..." mean nothing where the caller puts another CRS in the place of this one.
  std::vector<SourceWarning> warnings;
};

/// True where a key of the vertical part is among them.
[[nodiscard]] bool tell_of_heights(const GeoTiffKeys& keys);

/// Reads what GeoTIFF keys declare, as libgeotiff and GDAL know it; but VerticalUnits decides about
/// the heights' unit, whatever unit the vertical CRS has that stands beside it: programs name NAVD88
/// by the code of its metres, and feet by that key.
/// @throws nothing of its own; keys that are cut off are warned of
/// Cost: some milliseconds.
[[nodiscard]] DeclaredCrs crs_of_keys(const GeoTiffKeys& keys);

}  // namespace ptin
