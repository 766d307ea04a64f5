// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the pixels of a raster say of a terrain: its heights, or how its triangles lie.
#pragma once

#include <optional>
#include <string>

#include <gdal.h>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/slope.h"

namespace ptin::tools {

/// What a pixel says of the surface at its centre.
enum class PixelValue {
  kHeight,
  kSlope,     ///< 0 to 90 degrees, or percent.
  kAspect,    ///< Degrees clockwise from north, of where the surface falls to.
  kHillshade  ///< 1 to 255.
};

struct PixelContent {
  PixelValue value = PixelValue::kHeight;
  bool in_percent = false;  ///< Slopes.
  Light light{315, 45};     ///< Hillshades.
};

/// The type of the pixels: of heights Float32, or Float64 where Float32 does not hold every height of
/// a vertex; of slopes and aspects Float32, of hillshades bytes.
[[nodiscard]] GDALDataType type_of_pixels(const StoreFacts& facts, PixelValue value);

/// True when a height of the terrain may be this number as a pixel.
/// @param type  None: type_of_pixels().
[[nodiscard]] bool may_be_pixel(const StoreFacts& facts, double number,
                                std::optional<GDALDataType> type) noexcept;

/// A value for pixels without one: 0 of hillshades, else -9999; of heights, where -9999 may be one, the
/// lowest float, or of an integer type the least number, or else the largest, which may be one too.
/// @param type  None: type_of_pixels().
[[nodiscard]] double default_nodata(const StoreFacts& facts, PixelValue value,
                                    std::optional<GDALDataType> type = std::nullopt) noexcept;

/// The unit of the pixels; empty when it is unknown, or there is none.
[[nodiscard]] std::string unit_of_pixels(const PixelContent& content, const CrsFacts& crs);

/// The value of a pixel by the normal at its centre, over ground there; none where there is no
/// surface, and none of the aspect of what is flat.
/// @param per_map_unit  As that of slope_of().
/// REQUIRES: `content` is no height.
[[nodiscard]] std::optional<double> value_at(const GridNormal& normal, const PixelContent& content,
                                             const StoreFacts& facts, MapPoint per_map_unit);

}  // namespace ptin::tools
