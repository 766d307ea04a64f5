// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sheet around a map: its frame with coordinates, title, legend, and the lines that say what is
// shown.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/plot/canvas.h"
#include "tools/render/relief.h"
#include "tools/render/view.h"

namespace ptin::tools {

/// What a sheet says in words and numbers.
struct SheetText {
  std::string title;        ///< Empty: none, nor `detail`.
  std::string detail;       ///< How exact the picture is; at the other end of the title's line.
  std::string foot;         ///< CRS and source; wrapped below the legend.
  std::string length_unit;  ///< Names of units, of the ground's and of the heights'.
  std::string height_unit;
  bool is_in_degrees = false;  ///< Coordinates are longitudes and latitudes.
  /// Where true north lies at the middle of the map, radians clockwise from up. None: unknown.
  std::optional<double> north;
};

/// A sheet and the place of the map on it.
struct SheetLayout {
  int width = 0;  ///< Pixels.
  int height = 0;
  CanvasBox map{};
  std::vector<std::string> foot;  ///< Lines.
};

/// The layout of a sheet of this size; none where it is too small for a frame around a map, which then
/// fills it.
[[nodiscard]] std::optional<SheetLayout> layout_within(int width, int height,
                                                       const SheetText& text);
/// The same sheet with a frame that has this size, in the middle of the room for the map.
[[nodiscard]] SheetLayout with_frame(SheetLayout layout, double width, double height);
/// The layout of a sheet around a map of this size.
[[nodiscard]] std::optional<SheetLayout> layout_around(int map_width, int map_height,
                                                       const SheetText& text);

/// Draws all but the map: the frame with ticks at round coordinates, the title, a scale bar, the colours
/// with ticks at round heights, what voids and water look like where there are some, the foot; and an
/// arrow to the north where that is not up.
/// @param view  Of the map: its pixel (0, 0) is the corner of layout.map.
void draw_sheet(Canvas& canvas, const SheetLayout& layout, const View& view,
                const ReliefStyle& style, const SheetText& text);

}  // namespace ptin::tools
