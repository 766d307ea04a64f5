// SPDX-License-Identifier: GPL-3.0-or-later
//
// The background behind the sources of a VRT. GDAL hands out 0, or the nodata value, where no source of a
// band covers a sample, which nobody can tell from a height.
#pragma once

#include <string>

#include <gdal_priv.h>

namespace ptin {

/// A VRT opened once more, whose bands read as `background` where no source covers a sample: beyond
/// their rectangles, and where they have none of their own values (NODATA, UseMaskBand). VRTs that it
/// is made of are looked through. Null where the dataset is no VRT, or one that is computed in another
/// way (a pixel function, pansharpening): then its own values stand. A VRT that warps has an alpha band
/// behind its other ones instead, unless it has one or a nodata value.
/// @param background  A value that fits the type in which the bands will be read, and that no sample
///                    has: NaN, or a number.
/// Cost: parses the VRTs, and opens those in it.
[[nodiscard]] GDALDatasetUniquePtr open_with_background(GDALDataset& data,
                                                        const std::string& background);

}  // namespace ptin
