// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations of a raster beside its values that bear on where a sample is, how high it is, in
// which unit, and whether it counts: used, warned of, or refused (tools/API.md, "What a source
// declares").
#pragma once

#include <optional>
#include <string>

#include <gdal_priv.h>

#include "engine/construct/grid/source_warning.h"
#include "engine/construct/raster/raster_nodata.h"
#include "engine/construct/raster/raster_part.h"

namespace ptin {

/// The bands of a raster. All are GDAL's.
struct RasterBands {
  GDALRasterBand* height = nullptr;
  /// The band that is above 0 where a sample counts, of any type; null where there is none.
  GDALRasterBand* alpha = nullptr;
  /// A mask of bytes: one in the file, one beside it, or of a nodata value of the whole dataset.
  GDALRasterBand* mask = nullptr;
};

/// Opens a raster. Vertical parts of CRSs are asked for that GDAL leaves out by itself.
/// @param warnings  Receives what GDAL warns of.
/// @throws Error not_found, io_error; invalid_argument  not a raster
[[nodiscard]] GDALDatasetUniquePtr open_raster(const std::string& path, SourceWarnings& warnings);

/// The band of heights, and those that mask it.
/// @param is_overridden  The caller's nodata value replaces any declared one.
/// @throws Error invalid_argument  no band, or several
[[nodiscard]] RasterBands bands_of(GDALDataset& data, const std::string& path, bool is_overridden);

/// The nodata value of a band, of whatever type.
[[nodiscard]] std::optional<double> declared_nodata(GDALRasterBand& band);

/// Takes over what a raster declares.
/// @param warnings  Receives what there is to be warned of.
/// @throws Error invalid_argument  as RasterPart
[[nodiscard]] RasterShape shape_of(GDALDataset& data, GDALRasterBand& band, const std::string& path,
                                   SourceWarnings& warnings);

}  // namespace ptin
