// SPDX-License-Identifier: GPL-3.0-or-later
//
// The places of a coverage's pixels, in the terrain's CRS or in another one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "engine/query/questions.h"
#include "tools/export/raster_export.h"
#include "tools/serve/endpoint.h"
#include "tools/serve/places.h"

namespace ptin::serve {

/// Pixels of one size from a north-western corner on, in units of their CRS.
struct PixelFrame {
  double west = 0.0, north = 0.0;
  std::array<double, 2> size{};  ///< Width and height of a pixel.
  std::int64_t columns = 0, rows = 0;
};

/// How many pixels a client asks for along the sides; one alone: as many along the other as make
/// squares.
struct PixelCounts {
  std::optional<std::uint64_t> width, height;
  [[nodiscard]] bool given() const noexcept { return width || height; }
};

/// The part of OGC's `subset` or `scale-size` for one axis: "Lat(34.3:34.4)" has "34.3:34.4". Axes are
/// Lon, Long, Longitude, E, Easting or X, and Lat, Latitude, N, Northing or Y, in letters of any case.
/// @param axis  0: the one to the east, 1: the one to the north.
/// @throws http::Problem 400  it is no such list; an axis twice, or one that is not there
[[nodiscard]] std::optional<std::string_view> part_for_axis(std::string_view list, int axis,
                                                            std::string_view parameter);
/// Pixels that divide a window evenly.  REQUIRES: counts.given()
/// @throws http::Problem 400  the window has no area; a count of 0
[[nodiscard]] PixelFrame frame_dividing(const Window& window, const PixelCounts& counts);
/// Pixels of a size that cover a window, their sides at multiples of it: those of several windows fit
/// together.
[[nodiscard]] PixelFrame frame_covering(const Window& window, const std::array<double, 2>& size);
/// The side of a square pixel of the client's CRS that is as large as one of the terrain's own in the middle
/// of a window of the client's.
[[nodiscard]] double side_of_own_pixel(const Places& places, MapPoint own, const Window& window);

/// The heights at the centres of the pixels, block by block, each as locate() gives it.
/// @param places  Of the CRS of the frame and of `target`.
/// @throws http::Problem 400  a pixel lies where the terrain's CRS has no positions
///         Error as tools::export_raster()
/// Cost: of each pixel its transformation and what locate() costs. Memory: a block of pixels.
[[nodiscard]] tools::WrittenRaster write_frame(const Asked& asked, const Places& places,
                                               const PixelFrame& frame,
                                               const LocateRequest& request,
                                               const tools::RasterTarget& target);

}  // namespace ptin::serve
