// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is drawn over the relief: the edges of the triangles, and a legend.
#pragma once

#include <stop_token>
#include <string>

#include "tools/plot/canvas.h"
#include "tools/render/relief.h"
#include "tools/render/view.h"

namespace ptin::tools {

/// Draws every edge of the TIN that the view shows once. Opacity falls where edges are shorter than
/// a few pixels, so that dense parts stay legible.  @throws Error cancelled
void draw_wireframe(Canvas& canvas, const RefinedTin& refined, const StoreFacts& facts,
                    const View& view, const std::stop_token& stop = {});

/// Draws a scale bar into the lower left corner and, when colours show heights, the colours with
/// the lowest and the highest height. A picture too small for it gets none.
/// @param length_unit  The name of the ground's unit.
/// @param height_unit  The name of the heights' unit.
void draw_legend(Canvas& canvas, const View& view, const ReliefStyle& style,
                 const std::string& length_unit, const std::string& height_unit);

}  // namespace ptin::tools
