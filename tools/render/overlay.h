// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is drawn over the relief: the edges of the triangles, and a legend.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>

#include "tools/render/image.h"
#include "tools/render/relief.h"
#include "tools/render/view.h"

namespace ptin::tools {

/// A straight line one pixel wide, anti-aliased, of the given opacity (0 to 1).
void draw_line(Image& image, double x0, double y0, double x1, double y1, const Colour& colour,
               double opacity);

/// Draws digits and the letters of units ("-12.5 km"), 7 pixels high, from the upper left (x, y).
/// Other letters are blank.
void draw_text(Image& image, int x, int y, std::string_view text);
/// The width of a text in pixels.
[[nodiscard]] int text_width(std::string_view text);

/// Draws every edge of the TIN once. Opacity falls where edges are shorter than a few pixels, so
/// that dense parts stay legible.  @throws Error cancelled
void draw_wireframe(Image& image, const RefinedTin& refined, const StoreFacts& facts,
                    const View& view, const std::stop_token& stop = {});

/// Draws a scale bar into the lower left corner and, when colours tell heights, the colours with
/// the lowest and the highest height.
/// @param length_unit  Of ground units: "m", "ft", or "" when unknown.
/// @param height_unit  Of heights, likewise.
void draw_legend(Image& image, const View& view, const ReliefStyle& style,
                 const std::string& length_unit, const std::string& height_unit);

}  // namespace ptin::tools
